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

/// Returns a box that contains the saddle patch between two atoms with these van der Waals radii.
/// `directions` is the result of direction_bounds for its arc.
Box saddle_box(const ContactCircle& circle, const Box& directions,
               const std::array<double, 2>& atom_radii, double probe_radius);

}  // namespace eses::detail
