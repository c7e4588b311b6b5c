#pragma once
/// The circle in which two SAS spheres meet, and the cap that a neighbour cuts from a SAS sphere.

#include <algorithm>

#include "eses/vec3.hpp"
#include "geometry/tolerances.hpp"

namespace eses::detail {

/// A SAS sphere: van der Waals radius plus probe radius, angstrom.
struct SasSphere {
  Vec3 center;
  double radius = 0;
};

/// The part of a SAS sphere inside a neighbour's SAS ball: { c : (c - center) . axis > height }.
struct Cap {
  Vec3 axis;                   ///< unit, towards the neighbour
  double height = 0;           ///< distance of the cutting plane from the sphere's centre
  double blocking_height = 0;  ///< the same for a neighbour smaller by tolerance::accessible
};

/// The circle where the spheres meet; `axis` points from the first to the second centre.
struct ContactCircle {
  Vec3 center;
  Vec3 axis;
  double radius = 0;
  double first_height = 0;   ///< from the first centre to the plane, along the axis
  double second_height = 0;  ///< from the plane to the second centre, along the axis
};

/// The centres must differ.
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

/// The spheres must meet. `cap` is that of the second sphere on the first.
inline ContactCircle make_contact_circle(const SasSphere& first, const SasSphere& second,
                                         const Cap& cap) {
  const double squared_radius = (first.radius - cap.height) * (first.radius + cap.height);
  return {first.center + cap.height * cap.axis, cap.axis, std::sqrt(std::max(0.0, squared_radius)),
          cap.height, dot(second.center - first.center, cap.axis) - cap.height};
}

/// The spheres must meet.
inline ContactCircle make_contact_circle(const SasSphere& first, const SasSphere& second) {
  return make_contact_circle(first, second, make_cap(first, second));
}

/// A point in the half plane through a circle's axis, seen from the circle.
struct MeridianPoint {
  double height = 0;  ///< along the axis, above the circle's plane
  double inward = 0;  ///< from the circle towards the axis; negative outside the circle

  double squared_distance() const { return inward * inward + height * height; }
};

/// `offset` is the point's place from the circle's centre.
inline MeridianPoint meridian_point(const ContactCircle& circle, Vec3 offset) {
  const double height = dot(offset, circle.axis);
  // Not the root of |offset|^2 - height^2, which near the axis has lost half of its digits.
  return {height, circle.radius - norm(offset - height * circle.axis)};
}

/// Where a third SAS sphere meets the circle: at cos_half = C / D from `toward`, on both sides.
/// `cap` is that of the third sphere on the circle's first sphere.
struct CircleCut {
  Vec3 toward;           ///< unit, perpendicular to the circle's axis, towards the third centre
  double reach = 0;      ///< D: how far the circle varies along the cap's axis, angstrom
  double clearance = 0;  ///< C: height of the cap's plane above the circle's centre, angstrom

  double cos_half() const { return std::clamp(clearance / reach, -1.0, 1.0); }
};

inline CircleCut cut_circle(const ContactCircle& circle, const Cap& cap) {
  const double along = dot(circle.axis, cap.axis);
  const Vec3 across = cap.axis - along * circle.axis;
  const double length = norm(across);
  const Vec3 toward = length > 0 ? (1 / length) * across : any_perpendicular(circle.axis);
  return {toward, circle.radius * length, cap.height - circle.first_height * along};
}

}  // namespace eses::detail
