#pragma once
/// @file
/// Vectors with three components.

#include <cmath>
#include <cstddef>

namespace eses {

/// A point or a direction in space. Coordinates of points are in angstrom.
struct Vec3 {
  double x = 0;  ///< First component.
  double y = 0;  ///< Second component.
  double z = 0;  ///< Third component.

  /// The component along an axis: 0, 1, 2 for x, y, z.
  constexpr double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  /// A reference to the component along an axis.
  constexpr double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  /// Compares all components; 0 and -0 are equal.
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// The sum of two vectors.
constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
/// The difference of two vectors.
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
/// The opposite vector.
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
/// A vector times a number.
constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }

/// The scalar product.
constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// The vector product.
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The square of the length.
constexpr double squared_norm(Vec3 a) { return dot(a, a); }
/// The length.
inline double norm(Vec3 a) { return std::sqrt(squared_norm(a)); }

/// The unit vector in the direction of `a`, which must not be zero.
inline Vec3 normalized(Vec3 a) { return (1 / norm(a)) * a; }

/// Returns a unit vector that is perpendicular to `a`, which must not be zero.
inline Vec3 any_perpendicular(Vec3 a) {
  const double x = std::fabs(a.x), y = std::fabs(a.y), z = std::fabs(a.z);
  const Vec3 least = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(a, least));
}

}  // namespace eses
