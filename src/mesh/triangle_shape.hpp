#pragma once
/// Shapes and intersections of triangles.

#include <algorithm>
#include <array>

#include "eses/vec3.hpp"

namespace eses::detail::mesh {

using TrianglePoints = std::array<Vec3, 3>;

/// The smallest box around points.
struct Bounds {
  Vec3 low, high;

  explicit Bounds(const Vec3& point) : low(point), high(point) {}
  explicit Bounds(const TrianglePoints& t) : Bounds(t[0]) {
    extend(t[1]);
    extend(t[2]);
  }
  void extend(const Vec3& point) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
  }
  bool overlaps(const Bounds& other) const {
    return low.x <= other.high.x && low.y <= other.high.y && low.z <= other.high.z &&
           other.low.x <= high.x && other.low.y <= high.y && other.low.z <= high.z;
  }
};

/// Returns a vector perpendicular to a triangle, whose length is twice the area. It points to the
/// side from which the corners are counterclockwise.
inline Vec3 area_vector(const TrianglePoints& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// Returns the squared sine of the smallest angle of a triangle, which is at most 60 degrees, or 0
/// if two corners coincide. The angle is between the two longest sides. `area` is the area vector.
inline double squared_sine_of_smallest_angle(const TrianglePoints& t, const Vec3& area) {
  const double a = squared_norm(t[1] - t[0]), b = squared_norm(t[2] - t[1]),
               c = squared_norm(t[0] - t[2]);
  const double product = a * b * c;
  return product > 0 ? squared_norm(area) * std::min({a, b, c}) / product : 0;
}

/// Returns whether a segment and a triangle have a common point. May return true if they only come
/// within rounding errors of each other.
inline bool segment_meets_triangle(const Vec3& from, const Vec3& to, const TrianglePoints& t) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(a - d, cross(b - d, c - d));
  };
  const double side_from = volume(t[0], t[1], t[2], from), side_to = volume(t[0], t[1], t[2], to);
  if ((side_from > 0 && side_to > 0) || (side_from < 0 && side_to < 0)) return false;
  const double p = volume(from, to, t[0], t[1]), q = volume(from, to, t[1], t[2]),
               r = volume(from, to, t[2], t[0]);
  return (p >= 0 && q >= 0 && r >= 0) || (p <= 0 && q <= 0 && r <= 0);
}

}  // namespace eses::detail::mesh
