#pragma once
/// The rules of QualityMesh. Lengths are in units of the spacing, angles in degrees.

#include <cmath>
#include <cstdint>
#include <numbers>

#include "mesh/facing_cells.hpp"
#include "mesh/triangle_shape.hpp"

namespace eses::detail::mesh {

/// Number of planes between a stage and the stage before it. An operation at a plane changes
/// triangles with vertices about two planes away.
inline constexpr std::int32_t stage_planes = 2;
/// Number of stages after the collapse of short edges. They improve triangles with an angle below
/// `min_angle`.
inline constexpr std::int32_t improving_stages = 2;
inline constexpr double min_angle = 22;
/// Edges below this length are collapsed if possible, and the longest edge that this may leave.
inline constexpr double short_edge = 0.6, max_edge_of_short = 1.75;
/// Longest edge of any triangle. The edges of the plain mesh have at most the length of the
/// diagonal of a cell.
inline constexpr double max_edge = 2.25;
/// Smallest angle that a collapse of a short edge may leave. If there is an edge below `tiny_edge`,
/// the smallest angle may be halved instead: the crossings next to a grid point are collapsed one
/// after the other.
inline constexpr double min_angle_of_collapse = 0.001, tiny_edge = 1e-4;
/// Planes after which vertices are frozen, and the largest distance between the plane at which a
/// triangle was added and its vertices.
inline constexpr std::int32_t freeze_planes = stage_planes * (2 + improving_stages) + 2;
inline constexpr std::int32_t max_drift = 3;
static_assert(freeze_planes + 2 * max_drift <= FacingCells::kept_planes);
/// Planes below the frozen ones whose triangles may be near a triangle that changes.
inline constexpr std::int32_t kept_planes = 2 * max_drift;
/// Smallest scalar product of the normals of a new triangle and of the surface at its corners.
inline constexpr double min_facing = 0.2;
inline constexpr std::int32_t max_valence = 12;
/// Largest scalar product of the normals of triangles on both sides of an edge that counts as fold.
inline constexpr double fold = -0.98;
/// Scalar product of the normals at two corners of a triangle at a cusp.
inline constexpr double cusp = 0.5;

/// Returns the squared sine of an angle.
inline double squared_sine(double angle) {
  const double sine = std::sin(angle * std::numbers::pi / 180);
  return sine * sine;
}

/// Returns the quality of a triangle: the squared sine of its smallest angle. `area` is its area
/// vector.
inline float quality_of_shape(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& area) {
  return static_cast<float>(squared_sine_of_smallest_angle(a, b, c, area));
}
inline float quality_of_shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  return quality_of_shape(a, b, c, area_vector(a, b, c));
}

}  // namespace eses::detail::mesh
