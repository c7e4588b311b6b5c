#pragma once
/// Table of the triangles in a cell of the grid, by the set of its inside corners.
///
/// Marching cubes: W. E. Lorensen and H. E. Cline, "Marching cubes: a high resolution 3D surface
/// construction algorithm", Computer Graphics 21(4), 163-169 (1987), doi:10.1145/37402.37422.
/// The published table leaves holes at ambiguous faces, which have inside corners at the ends of
/// one diagonal only. One rule decides all ambiguous faces here (see case_table()), as in
/// C. Montani, R. Scateni and R. Scopigno, "A modified look-up table for implicit disambiguation of
/// marching cubes", The Visual Computer 10, 353-355 (1994), doi:10.1007/BF01900830.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace eses::detail::mesh {

inline constexpr std::size_t corner_count = 8;
inline constexpr std::size_t edge_count = 12;
inline constexpr std::size_t case_count = 256;
inline constexpr std::size_t max_triangles = 5;  ///< in one cell
/// Largest number of triangles at a vertex, in the four cells at its edge.
inline constexpr std::size_t max_vertex_triangles = 17;

/// An edge of the cell, which runs along `axis` from its lower corner. Corner c has the coordinates
/// (c & 1, c >> 1 & 1, c >> 2 & 1).
struct CellEdge {
  std::size_t axis = 0;
  std::size_t corner = 0;
};

/// Returns the edges, ordered by lower corner, then axis.
constexpr std::array<CellEdge, edge_count> make_cell_edges() {
  std::array<CellEdge, edge_count> edges;
  std::size_t count = 0;
  for (std::size_t corner = 0; corner < corner_count; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if ((corner >> axis & 1) == 0) edges[count++] = {axis, corner};
  return edges;
}
inline constexpr std::array<CellEdge, edge_count> cell_edges = make_cell_edges();

/// The cell edges on which the three vertices of a triangle lie, counterclockwise seen from outside
/// the surface.
using CellTriangle = std::array<std::uint8_t, 3>;

/// The triangles of a cell.
struct CellCase {
  std::array<CellTriangle, max_triangles> triangles{};
  std::size_t count = 0;

  std::span<const CellTriangle> all() const { return std::span(triangles).first(count); }
};

/// Returns the table. Bit c of the index is set if corner c is inside.
///
/// On each face of a cell, a segment cuts off every run of adjacent inside corners. On an ambiguous
/// face, the two inside corners are therefore separated. The rule depends on the face alone, so
/// that the two cells at a face have the same segments. The segments on the faces of a cell form
/// closed polygons, which are divided into triangles by diagonals that lie in no face. Such a
/// diagonal belongs to one cell only. Each edge of a triangle hence belongs to exactly two
/// triangles, and the triangles around each vertex form one fan. The triangles of a cell do not
/// intersect each other, wherever the vertices are on their edges; doc/algorithm.md has the proof.
const std::array<CellCase, case_count>& case_table();

}  // namespace eses::detail::mesh
