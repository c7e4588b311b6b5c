#pragma once
/// Intersections of the triangles of a mesh, in exact arithmetic.

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "eses/vec3.hpp"
#include "support/mesh_files.hpp"

namespace eses::detail::test {

/// Returns the sign of det(b - a, c - a, d - a), without rounding.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Returns whether two triangles have a common point that is neither a common corner nor on a
/// common side. Touching triangles intersect, and so do triangles without an area.
bool do_intersect(std::span<const Vec3> positions, const MeshTriangle& one,
                  const MeshTriangle& other);

/// Returns the indices of all pairs of triangles that intersect.
std::vector<std::pair<std::size_t, std::size_t>> find_intersections(
    std::span<const Vec3> positions, std::span<const MeshTriangle> triangles);

}  // namespace eses::detail::test
