#pragma once
/// Shapes and intersections of triangles.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
inline Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }
inline Vec3 area_vector(const TrianglePoints& t) { return area_vector(t[0], t[1], t[2]); }

/// Returns the squared sine of the smallest angle of a triangle, which is at most 60 degrees, or 0
/// if two corners coincide. The angle is between the two longest sides. `area` is the area vector.
inline double squared_sine_of_smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c,
                                             const Vec3& area) {
  const double ab = squared_norm(b - a), bc = squared_norm(c - b), ca = squared_norm(a - c);
  const double product = ab * bc * ca;
  return product > 0 ? squared_norm(area) * std::min(std::min(ab, bc), ca) / product : 0;
}

/// Returns a bound of the rounding errors of the scalar product of `area_vector` and any vector
/// whose components are at most 1: each product of two components has a relative error of 7 / 2
/// epsilon.
inline double area_error(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double relative_error = 4 * std::numeric_limits<double>::epsilon();
  const auto length = [](const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
  };
  return relative_error * length(b - a) * length(c - a);
}

/// Returns the sign of the volume of the tetrahedron a, b, c, d, or 0 if rounding errors may decide
/// it. It is positive if a, b and c are clockwise seen from d. The bound is that of J. R. Shewchuk,
/// Discrete & Computational Geometry 18 (1997), 305-363, doi:10.1007/PL00009321, rounded up.
inline int certain_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr double relative_error = 4 * std::numeric_limits<double>::epsilon();
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double volume = dot(u, cross(v, w));
  const auto size = [](double x, double y) { return std::fabs(x) + std::fabs(y); };
  const double sum = std::fabs(u.x) * size(v.y * w.z, v.z * w.y) +
                     std::fabs(u.y) * size(v.z * w.x, v.x * w.z) +
                     std::fabs(u.z) * size(v.x * w.y, v.y * w.x);
  return std::fabs(volume) <= relative_error * sum ? 0 : volume > 0 ? 1 : -1;
}

/// Returns whether a segment and a triangle have a common point. May return true if they only come
/// within rounding errors of each other.
inline bool segment_meets_triangle(const Vec3& from, const Vec3& to, const TrianglePoints& t) {
  if (certain_side(t[0], t[1], t[2], from) * certain_side(t[0], t[1], t[2], to) > 0) return false;
  const int p = certain_side(from, to, t[0], t[1]), q = certain_side(from, to, t[1], t[2]),
            r = certain_side(from, to, t[2], t[0]);
  return std::min({p, q, r}) >= 0 || std::max({p, q, r}) <= 0;
}

}  // namespace eses::detail::mesh
