#pragma once
/// Parts of a mesh as numbers.

#include <cstdint>
#include <vector>

#include "mesh/triangle_shape.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::detail::mesh {

/// A part of a mesh: consecutive vertices, and triangles. The corners of the triangles are in this
/// piece or in pieces before it. `triangle_patches` and `corners` have a value for each triangle if
/// the format of the mesh needs them, see PieceContents.
struct MeshPiece {
  std::uint64_t vertex_count = 0;
  std::vector<Vertex> vertices;  ///< empty if the format has only the positions of corners
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
