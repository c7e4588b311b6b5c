#pragma once
/// Integrals over saddle patches.

#include <cmath>

#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// Integrals over a part of the surface.
struct SurfaceIntegrals {
  double area = 0;
  Vec3 vector_area;  ///< integral of the outward normal
  double flux = 0;   ///< integral of the scalar product of position and outward normal
  Vec3 moment;       ///< integral of the cross product of position and outward normal

  SurfaceIntegrals& operator+=(const SurfaceIntegrals& other) {
    area += other.area;
    vector_area = vector_area + other.vector_area;
    flux += other.flux;
    moment = moment + other.moment;
    return *this;
  }
};

/// A point of the probe's outline, by its angle at the probe's centre, from the direction to the
/// circle's centre towards the second atom. At 0, the outline is nearest to the axis. The angle is
/// in [-pi/2, pi/2], so points are ordered by their sines.
struct OutlinePoint {
  double sine = 0, cosine = 1;
};

/// An interval of the outline.
struct OutlineRange {
  OutlinePoint low, high;

  bool is_empty() const { return low.sine >= high.sine; }
  /// The angle between the ends (radians).
  double length() const {
    return std::atan2(high.sine * low.cosine - high.cosine * low.sine,
                      high.cosine * low.cosine + high.sine * low.sine);
  }
};

/// The outline of the probe between its points of contact with two atoms.
struct SaddleOutline {
  double rho = 0;        ///< radius of the contact circle, angstrom
  double probe = 0;      ///< radius of the probe, angstrom
  OutlineRange contact;  ///< from the first atom to the second
  OutlinePoint cusp;     ///< begins the part beyond the axis; its sine is 0 if there is none

  /// Calls `action(range)` for the parts of a range that are not beyond the axis.
  template <class Action>
  void for_each_part(const OutlineRange& range, Action&& action) const;
};

SaddleOutline make_outline(const ContactCircle& circle, double probe);

/// The border between the atoms of a saddle in the power diagram.
struct SaddleBorder {
  OutlinePoint point;  ///< clamped to the points of contact
  double sine = 0;     ///< of the angle of the border, which is not clamped
};

/// Returns the border. The radii are those of both spheres, SAS or van der Waals.
SaddleBorder find_border(const SaddleOutline& outline, const ContactCircle& circle,
                         double first_radius, double second_radius);

/// The arc of a saddle: its angle about the axis, and the integral of the radial unit vector.
struct SweptArc {
  double angle = 0;
  Vec3 radial;
};

/// Returns the integrals over the part of a saddle patch in a range of the outline, without the
/// part beyond the axis. Positions are relative to the circle's centre.
SurfaceIntegrals saddle_integrals(const SaddleOutline& outline, const OutlineRange& range,
                                  Vec3 axis, const SweptArc& arc);

template <class Action>
void SaddleOutline::for_each_part(const OutlineRange& range, Action&& action) const {
  const auto act = [&](const OutlineRange& part) {
    if (!part.is_empty()) action(part);
  };
  if (cusp.sine == 0) return act(range);
  const OutlinePoint mirrored{-cusp.sine, cusp.cosine};
  act({range.low, range.high.sine < mirrored.sine ? range.high : mirrored});
  act({range.low.sine > cusp.sine ? range.low : cusp, range.high});
}

}  // namespace eses::detail
