#pragma once
/// Bounding boxes of patches of the surface. Lengths are in angstrom.

#include <array>

#include "geometry/box.hpp"
#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// Returns the box of the spherical cap { center + radius u : u . pole >= cosine }, where `pole`
/// and u are unit vectors.
Box cap_box(Vec3 center, double radius, Vec3 pole, double cosine);

/// Returns a box that contains the spherical triangle with these corner directions (unit vectors).
Box concave_box(Vec3 center, double radius, const std::array<Vec3, 3>& corners);

/// Boxes of patches are extended by this, so that they contain the seams (angstrom).
inline constexpr double box_slack = 1e-5;

/// A box in single precision, relative to a point near it.
struct FloatBox {
  std::array<float, 3> low{}, high{};

  /// Returns the box in space.
  Box around(Vec3 point) const {
    return {point + Vec3{low[0], low[1], low[2]}, point + Vec3{high[0], high[1], high[2]}};
  }
};

/// Boxes around the saddle patch of an arc, with slack, relative to the centre of its first atom.
struct ArcBoxes {
  FloatBox solid;    ///< of the arc, the saddle patch and the points between the two
  FloatBox surface;  ///< of the saddle patch
};

/// Returns the boxes of an arc. See saddle_box for the other arguments.
ArcBoxes arc_boxes(Vec3 first_center, const ContactCircle& circle, const Box& directions,
                   const std::array<double, 2>& atom_radii, double probe_radius);

/// Returns a box that contains the saddle patch between two atoms with these van der Waals radii.
/// `directions` is the result of direction_bounds for its arc.
Box saddle_box(const ContactCircle& circle, const Box& directions,
               const std::array<double, 2>& atom_radii, double probe_radius);

}  // namespace eses::detail
