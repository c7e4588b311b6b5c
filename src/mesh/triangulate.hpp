#pragma once
/// Marching cubes: triangles from points and crossings, one row of cells at a time.

#include <array>
#include <cstdint>
#include <vector>

#include "eses/vec3.hpp"

namespace eses::detail::mesh {

/// Points and crossings of a row of the grid along x. Vertices are numbered like the crossings: by
/// lower point (z, y, x), then axis.
struct Row {
  std::vector<std::uint64_t> inside;  ///< point i is bit i % 64 of word i / 64
  std::vector<std::uint64_t> edges;   ///< keys of the edges that have a crossing, ascending
  std::uint64_t first_vertex = 0;     ///< number of the first crossing
  std::vector<std::uint8_t>
      patches;                  ///< patches of the crossings; empty unless patch_of needs them
  std::vector<Vec3> positions;  ///< of the vertices; empty unless corners_of needs them
};

/// Key of the edge along `axis` whose lower point is point `x` of the row.
constexpr std::uint64_t edge_key(std::uint64_t x, std::uint64_t axis) { return x << 2 | axis; }

/// Numbers of three vertices, counterclockwise seen from outside the surface.
using Triangle = std::array<std::uint64_t, 3>;

/// The rows of points around a row of cells: (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1).
using CellRows = std::array<const Row*, 4>;

/// Scratch memory of triangulate(): the vertices of four rows, each by the key of its edge. Slots
/// of edges without a vertex keep old values, which are not read.
using EdgeVertices = std::vector<std::uint64_t>;
/// Returns the number of slots that rows of `points_x` points need.
constexpr std::size_t edge_slots(std::int64_t points_x) {
  return std::tuple_size_v<CellRows> * edge_key(static_cast<std::uint64_t>(points_x), 0);
}

/// Appends the triangles of a row of cells, ordered by x. Each edge whose ends are classified
/// differently must have a crossing in the row of its lower point.
void triangulate(const CellRows& rows, std::int64_t points_x, EdgeVertices& vertices,
                 std::vector<Triangle>& triangles);

/// Returns the patch of a triangle: the median of the patches of its corners. This is the patch of
/// at least two corners, or saddle if all three differ.
std::uint8_t patch_of(std::array<std::uint8_t, 3> corner_patches);

/// Does the same for a triangle of a row of cells. The rows must have patches.
std::uint8_t patch_of(const CellRows& rows, const Triangle& triangle);

/// Returns the positions of the corners of a triangle of a row of cells. The rows must have
/// positions.
std::array<Vec3, 3> corners_of(const CellRows& rows, const Triangle& triangle);

}  // namespace eses::detail::mesh
