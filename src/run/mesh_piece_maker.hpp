#pragma once
/// The mesh of a sweep, as numbers.

#include <cstdint>
#include <mutex>
#include <vector>

#include "mesh/piece.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_format.hpp"
#include "run/layer.hpp"
#include "run/planned_run.hpp"

namespace eses::detail {

/// Makes the meshes of pieces from layers. The cells between two planes are triangulated when the
/// upper plane is made, so the last plane of a finished layer is kept. The cells of a region are
/// the cells whose lowest corner is in the region, so that regions that divide the grid have each
/// cell once. There are no vertices without cells.
class MeshPieceMaker {
 public:
  /// Scratch memory of a thread.
  struct Scratch {
    /// Rows with the same y in two neighbouring planes.
    struct RowPair {
      mesh::Row lower, upper;
    };
    RowPair front, back;  ///< rows y and y + 1
    mesh::EdgeVertices edge_vertices;
  };

  /// Makes pieces of the cells of the run that belong to `tiling`. The run has a mesh. Keeps
  /// references to both.
  MeshPieceMaker(const PlannedRun& run, const BlockTiling& tiling);

  /// Returns the estimated memory in bytes of the vertex numbers of a layer's rows, and of the
  /// plane that is kept. `plane_crossings` is the expected number of crossings of a plane.
  static double memory_bytes(const BlockTiling& tiling, const mesh::PieceContents& contents,
                             double plane_crossings);

  /// Makes a piece of the layer: the vertices on edges that start in the rows of one of its
  /// `batch_count` batches, and the cells below and before them. Needs the halo crossings of
  /// blocks. Several threads may call it for batches of the same layer. Layers must be made in
  /// order, with a call of `release` after each.
  void make(const Layer& layer, std::int64_t batch, std::int64_t batch_count, Scratch& scratch,
            mesh::MeshPiece& piece);
  /// Keeps the last plane of a finished layer.
  void release(const Layer& layer);
  /// Sets the plane below the first layer, whose vertices belong to another part of the mesh.
  void go_on_from(const Layer& below);

  std::uint64_t vertex_count() const { return layer_begin_; }

 private:
  struct LayerView;

  mesh::Vertex make_plain_vertex(const GridIndex& lower, const BlockCrossing& crossing) const;
  mesh::Vertex make_vertex(const GridIndex& lower, const BlockCrossing& crossing) const;
  std::int64_t planes_of(const Layer& layer) const;
  void number_rows(const Layer& layer);
  GridIndex index_of(const LayerView& view, std::int64_t x, std::int64_t y, std::int64_t z) const;
  void make_row(const LayerView& view, std::int64_t y, std::int64_t z, mesh::Row& row) const;
  const mesh::Row& lower_row(const Scratch::RowPair& pair, std::int64_t y, std::int64_t z) const;
  void make_rows(const LayerView& view, std::int64_t row, Scratch::RowPair& pair) const;
  bool is_crossed(std::int64_t y, std::int64_t z) const;
  bool has_triangles(std::int64_t y, std::int64_t z) const;
  void add_vertices(const LayerView& view, const RowRange& rows, mesh::MeshPiece& piece) const;
  void add_triangles(const LayerView& view, const RowRange& rows, Scratch& scratch,
                     mesh::MeshPiece& piece) const;

  const PlannedRun& run_;
  const MeshOptions& choice_;
  const BlockTiling& tiling_;
  GridRegion region_;  // region of the mesh; rows are relative to it
  MeshFormat format_;
  mesh::PieceContents contents_;
  std::int64_t rows_y_;  // number of rows of a plane
  bool has_cells_;
  std::mutex mutex_;
  bool is_numbered_ = false;       // whether the rows of the current layer are numbered
  std::uint64_t layer_begin_ = 0;  // index of the first vertex of the current layer
  std::vector<std::uint64_t>
      row_begin_;                 // index of the first vertex of each row [z][y]; and the end
  std::vector<mesh::Row> below_;  // last plane of the previous layer, by y
};

}  // namespace eses::detail
