#pragma once
/// From points and crossings to triangles, a row of cells at a time. Knows no blocks and no files.

#include <array>
#include <cstdint>
#include <vector>

namespace eses::detail::mesh {

/// What the mesh needs of a row of the grid along x. Vertices are numbered like the crossings: by
/// lower point (z, y, x), then axis.
struct Row {
  std::vector<std::uint64_t> inside;  ///< bit i % 64 of word i / 64 is point i
  std::vector<std::uint64_t> edges;   ///< with a crossing: `edge_key`, ascending
  std::uint64_t first_vertex = 0;     ///< number of the first crossing
  std::vector<std::uint8_t> patches;  ///< of the crossings, for `patch_of`; else empty
};

constexpr std::uint64_t edge_key(std::uint64_t x, std::uint64_t axis) { return x << 2 | axis; }

/// Numbers of three vertices, counterclockwise seen from outside the surface.
using Triangle = std::array<std::uint64_t, 3>;

/// The rows around a row of cells: (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1).
using CellRows = std::array<const Row*, 4>;

/// Appends the triangles of a row of cells, by x. All edges whose ends differ must have a crossing,
/// in the rows along x, y and z where these edges start.
void triangulate(const CellRows& rows, std::int64_t points_x, std::vector<Triangle>& triangles);

/// The patch of a triangle of these rows, which must have patches: the median of its corners'
/// patches. That is the patch of at least two corners, or saddle where all three differ.
std::uint8_t patch_of(const CellRows& rows, const Triangle& triangle);

}  // namespace eses::detail::mesh
