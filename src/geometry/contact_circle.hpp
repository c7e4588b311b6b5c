#pragma once
/// The circle in which two SAS spheres meet, and the cap that a neighbour cuts from a SAS sphere
/// (Connolly, J. Appl. Cryst. 16, 548, 1983, doi:10.1107/S0021889883010985).

#include <algorithm>

#include "eses/vec3.hpp"
#include "geometry/tolerances.hpp"

namespace eses::detail {

/// A SAS sphere. Its radius is the van der Waals radius plus the probe radius, in angstrom.
struct SasSphere {
  Vec3 center;
  double radius = 0;
};

/// The part of a SAS sphere inside a neighbour's SAS ball: { c : (c - center) . axis > height }.
/// Lengths are in angstrom.
struct Cap {
  Vec3 axis;          ///< unit vector towards the neighbour
  double height = 0;  ///< signed distance of the cutting plane from the sphere's centre
  double blocking_height =
      0;  ///< `height` for a neighbour that is smaller by tolerance::accessible
};

/// The circle in which two SAS spheres meet. Lengths are in angstrom.
struct ContactCircle {
  Vec3 center;
  Vec3 axis;  ///< unit vector from the first to the second sphere's centre
  double radius = 0;
  double first_height = 0;   ///< from the first centre to the plane, along the axis
  double second_height = 0;  ///< from the plane to the second centre, along the axis
};

/// Returns the cap that a neighbour with another centre cuts from a sphere. With the distance d of
/// the centres, its height is (d^2 + R^2 - R_n^2) / (2 d). The derivative by R_n is -R_n / d, which
/// gives the blocking height.
inline Cap make_cap(const SasSphere& sphere, const SasSphere& neighbour) {
  const Vec3 to_neighbour = neighbour.center - sphere.center;
  const double squared = squared_norm(to_neighbour);
  const double inverse = 1 / std::sqrt(squared);
  const double height =
      0.5 * inverse *
      (squared + (sphere.radius - neighbour.radius) * (sphere.radius + neighbour.radius));
  return {inverse * to_neighbour, height,
          height + tolerance::accessible * neighbour.radius * inverse};
}

/// Returns a cap of the first sphere that contains the same points of its contact circle with the
/// second one as the ball of the third one. It is bounded by the plane in which the second and the
/// third sphere meet. If these are nearly equal, their caps on the first sphere are, too, and
/// rounding errors of those would be divided by the small distance of the centres.
inline Cap make_cap_from_second(const SasSphere& first, const SasSphere& second,
                                const SasSphere& third) {
  Cap cap = make_cap(second, third);
  const double offset = dot(second.center - first.center, cap.axis);
  cap.height += offset;
  cap.blocking_height += offset;
  return cap;
}

/// Returns whether the centres are those of nearly equal atoms.
inline bool are_nearly_equal(const SasSphere& a, const SasSphere& b) {
  return squared_norm(a.center - b.center) < tolerance::nearly_equal * tolerance::nearly_equal;
}

/// Returns the contact circle of two spheres that meet. `cap` is the cap that the second one cuts
/// from the first one.
inline ContactCircle make_contact_circle(const SasSphere& first, const SasSphere& second,
                                         const Cap& cap) {
  const double squared_radius = (first.radius - cap.height) * (first.radius + cap.height);
  return {first.center + cap.height * cap.axis, cap.axis, std::sqrt(std::max(0.0, squared_radius)),
          cap.height, dot(second.center - first.center, cap.axis) - cap.height};
}

/// Returns the contact circle of two spheres that meet.
inline ContactCircle make_contact_circle(const SasSphere& first, const SasSphere& second) {
  return make_contact_circle(first, second, make_cap(first, second));
}

/// Coordinates of a point in the half plane that is bounded by a circle's axis, with the origin on
/// the circle, in angstrom.
struct MeridianPoint {
  double height = 0;  ///< along the axis, above the circle's plane
  double inward = 0;  ///< from the circle towards the axis; negative outside the circle

  /// Squared distance of the point from the circle.
  double squared_distance() const { return inward * inward + height * height; }
};

/// Returns the meridian coordinates of the point at `offset` from the circle's centre.
inline MeridianPoint meridian_point(const ContactCircle& circle, Vec3 offset) {
  const double height = dot(offset, circle.axis);
  // The root of |offset|^2 - height^2 would lose half of the digits near the axis.
  return {height, circle.radius - norm(offset - height * circle.axis)};
}

/// The two points in which a third SAS sphere meets the circle. Seen from the circle's centre, they
/// are at the angle acos(clearance / reach) from `toward`, on both sides.
struct CircleCut {
  Vec3 toward;  ///< unit vector in the circle's plane, towards the third centre
  double reach =
      0;  ///< maximum height of the circle above its centre along the cap's axis, angstrom
  double clearance = 0;  ///< height of the cap's plane above the circle's centre, angstrom

  /// Cosine of half the angle between the two points.
  double cos_half() const { return std::clamp(clearance / reach, -1.0, 1.0); }
};

/// Returns the cut of the circle with the third sphere that cuts `cap` from the circle's first
/// sphere.
inline CircleCut cut_circle(const ContactCircle& circle, const Cap& cap) {
  const double along = dot(circle.axis, cap.axis);
  const Vec3 across = cap.axis - along * circle.axis;
  const double length = norm(across);
  const Vec3 toward = length > 0 ? (1 / length) * across : any_perpendicular(circle.axis);
  return {toward, circle.radius * length, cap.height - circle.first_height * along};
}

}  // namespace eses::detail
