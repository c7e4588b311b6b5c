#pragma once
/// Which triangles a cell of the grid holds, by which of its corners are inside.
///
/// W. E. Lorensen, H. E. Cline, "Marching cubes: a high resolution 3D surface construction
/// algorithm", SIGGRAPH 1987; here the table follows from one rule for the faces, see below.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace eses::detail::mesh {

inline constexpr std::size_t corner_count = 8;
inline constexpr std::size_t edge_count = 12;
inline constexpr std::size_t case_count = 256;
inline constexpr std::size_t max_triangles = 5;  ///< in one cell

/// Corner c stands at (c & 1, c >> 1 & 1, c >> 2 & 1). An edge runs along `axis` from its lower
/// corner.
struct CellEdge {
  std::size_t axis = 0;
  std::size_t corner = 0;
};

/// By lower corner, then axis.
constexpr std::array<CellEdge, edge_count> make_cell_edges() {
  std::array<CellEdge, edge_count> edges;
  std::size_t count = 0;
  for (std::size_t corner = 0; corner < corner_count; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if ((corner >> axis & 1) == 0) edges[count++] = {axis, corner};
  return edges;
}
inline constexpr std::array<CellEdge, edge_count> cell_edges = make_cell_edges();

/// Three edges of the cell, on which the corners lie, counterclockwise seen from outside the
/// surface.
using CellTriangle = std::array<std::uint8_t, 3>;

/// The triangles of a cell.
struct CellCase {
  std::array<CellTriangle, max_triangles> triangles{};
  std::size_t count = 0;

  std::span<const CellTriangle> all() const { return std::span(triangles).first(count); }
};

/// By the inside corners: bit c stands for corner c.
///
/// On each face of a cell, every run of inside corners is cut off by a segment; so where two
/// opposite corners are inside, they are parted. Both cells at the face see it alike, hence their
/// segments meet. The segments of a cell's faces join to polygons; these are cut into triangles by
/// diagonals that lie in no face, which no other cell can have. So every edge of a triangle belongs
/// to exactly one more, and around each vertex the triangles form one fan.
const std::array<CellCase, case_count>& case_table();

}  // namespace eses::detail::mesh
