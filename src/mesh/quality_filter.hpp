#pragma once
/// The improvement of a mesh between its making and its file.

#include <cstdint>
#include <deque>
#include <functional>
#include <span>

#include "mesh/piece.hpp"
#include "mesh/quality_mesh.hpp"

namespace eses::detail::mesh {

/// Improves the triangles of a mesh that arrives in pieces. See QualityMesh.
class QualityFilter {
 public:
  using Sink = std::function<void(const MeshPiece& piece)>;

  /// `region` has the points of all triangles. The pieces of the result have `contents`.
  QualityFilter(const Grid& grid, const GridRegion& region, PieceContents contents, Sink sink);

  /// Adds the next piece, which has vertices.
  void add(const MeshPiece& piece);
  /// Passes on the last triangles.
  void finish();

  MeshQuality quality() const { return mesh_.quality(); }

  /// Returns the estimated memory in bytes. `window_crossings` is the expected number of crossings
  /// between the planes of the window.
  static double memory_bytes(const GridRegion& region, double window_crossings) {
    return QualityMesh::memory_bytes(region, window_crossings, sizeof(VertexLabels));
  }

 private:
  void take_vertex(std::uint64_t number);
  void take_triangles(std::span<const Triangle> triangles);

  std::int64_t first_row_;  // of the region
  PieceContents contents_;
  Sink sink_;
  QualityMesh mesh_;
  std::deque<VertexLabels> labels_;  // of the vertices that are not delivered
  std::uint64_t first_label_ = 0;    // number of the vertex of the first labels
  MeshPiece result_;
};

}  // namespace eses::detail::mesh
