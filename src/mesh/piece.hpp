#pragma once
/// Parts of a mesh as numbers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/vec3.hpp"
#include "mesh/triangle_shape.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::detail::mesh {

/// The data of a vertex in mesh files besides its position and normal.
struct VertexLabels {
  std::array<std::int32_t, 3> lower{};  ///< lower end of the grid edge
  std::uint8_t axis = 0;     ///< of the edge; the other coordinates are coordinates of `lower`
  std::uint8_t patch = 1;    ///< 1 convex, 2 saddle, 3 concave
  std::uint16_t unused = 0;  ///< explicit padding, as pieces are written to disk
  /// File index of the atom; in a mesh in memory, index of the crossing.
  std::uint32_t source = 0;
  std::uint32_t chain = 0, residue = 0;  ///< see GroupNumbers
  std::uint32_t component = 0;           ///< 0 outside, or the number of the cavity
  double potential = 0;                  ///< kT/e
};

/// A vertex of a mesh file. It does not depend on the process that has made it.
struct FileVertex {
  Vec3 position;  ///< angstrom
  Vec3 normal;    ///< outward unit normal
  VertexLabels labels;
};
static_assert(sizeof(FileVertex) == 88);  // without implicit padding

/// Returns a vertex without the labels that do not follow from its crossing.
inline FileVertex file_vertex(const Vertex& vertex) {
  FileVertex result{vertex.position, vertex.normal, {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    result.labels.lower[axis] = static_cast<std::int32_t>(vertex.lower[axis]);
  result.labels.axis = vertex.axis;
  result.labels.patch = vertex.patch;
  return result;
}

/// A part of a mesh: consecutive vertices, and triangles. The corners of the triangles are in this
/// piece or in pieces before it. `triangle_patches` and `corners` have a value for each triangle if
/// the format of the mesh needs them, see PieceContents.
struct MeshPiece {
  std::uint64_t vertex_count = 0;
  std::vector<FileVertex> vertices;  ///< empty if the format has only the positions of corners
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> triangle_patches;  ///< see patch_of
  std::vector<TrianglePoints> corners;         ///< positions

  void clear() {
    vertex_count = 0;
    vertices.clear();
    triangles.clear();
    triangle_patches.clear();
    corners.clear();
  }
};

/// The lists of a piece that a format needs.
struct PieceContents {
  bool vertices = true, triangle_patches = false, corners = false;
};

}  // namespace eses::detail::mesh
