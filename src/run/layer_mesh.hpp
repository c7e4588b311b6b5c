#pragma once
/// The mesh of layers of blocks.

#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "input/file_index.hpp"
#include "input/potential_map.hpp"
#include "mesh/piece.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_groups.hpp"
#include "run/layer.hpp"
#include "run/plan.hpp"

namespace eses::detail {

/// Makes the vertices of a mesh.
struct VertexMaker {
  Grid grid;
  double clearance = mesh::clearance;  ///< see mesh::make_vertex
  FileIndices file_indices = {};
  std::span<const Atom> atoms = {};  ///< by slab index
  /// Whether the label names the closest adjacent atom, and not the first one.
  bool names_closest_atom = false;
  std::span<const mesh::GroupNumbers> groups = {};  ///< by slab index; empty if they are not known
  const PotentialMap* potential = nullptr;          ///< null without a potential
  double potential_offset = 0;                      ///< see MeshPotential
  /// Returns the component of a crossing at a position; empty if components are not known.
  std::function<std::uint32_t(const BlockCrossing& crossing, Vec3 position)> component_of = {};

  /// Returns the vertex of a crossing. `lower` is the lower end of its grid edge. Throws Error if
  /// the map of the potential does not contain the vertex.
  mesh::Vertex operator()(const GridIndex& lower, const BlockCrossing& crossing) const;
  /// Returns only its position.
  Vec3 position_of(const GridIndex& lower, const BlockCrossing& crossing) const {
    return mesh::make_vertex(grid, lower, crossing, clearance).position;
  }
};

/// Scratch memory of a thread that makes a part of the mesh.
struct MeshScratch {
  /// Rows with the same y in two neighbouring planes.
  struct RowPair {
    mesh::Row lower, upper;
  };
  RowPair front, back;  ///< rows y and y + 1
  mesh::EdgeVertices edge_vertices;
  std::uint64_t triangle_count = 0;  ///< total number of triangles of this thread
};

/// The mesh of a region. The cells between two planes are triangulated when the upper plane is
/// made, so the last plane of a finished layer is kept. The cells of a region are the cells whose
/// lowest corner is in the region, so that regions that divide the grid have each cell once. There
/// are no vertices without cells.
class LayerMesh {
 public:
  /// Makes pieces with `contents` of the cells that have all their corners in `region`, as far as
  /// they belong to `plan.tiling`. Keeps a reference to `plan`.
  LayerMesh(const Plan& plan, const GridRegion& region, mesh::PieceContents contents,
            VertexMaker make_vertex);

  /// Returns the estimated memory in bytes of the vertex numbers of a layer's rows, and of the
  /// plane that is kept. `plane_crossings` is the expected number of crossings of a plane.
  static double memory_bytes(const BlockTiling& tiling, const mesh::PieceContents& contents,
                             double plane_crossings);

  /// Makes a piece of the layer: the vertices on edges that start in the rows of one of its
  /// `batch_count` batches, and the cells below and before them. Needs the halo crossings of
  /// blocks. Several threads may call it for batches of the same layer. Layers must be made in
  /// order, with a call of `release` after each.
  void make(const Layer& layer, std::int64_t batch, std::int64_t batch_count, MeshScratch& scratch,
            mesh::MeshPiece& piece);
  /// Keeps the last plane of a finished layer.
  void release(const Layer& layer);
  /// Sets the plane below the first layer, whose vertices belong to another part of the mesh.
  void go_on_from(const Layer& below);

  std::uint64_t vertex_count() const { return layer_begin_; }

 private:
  struct LayerView;

  std::int64_t planes_of(const Layer& layer) const;
  void number_rows(const Layer& layer);
  GridIndex index_of(const LayerView& view, std::int64_t x, std::int64_t y, std::int64_t z) const;
  void make_row(const LayerView& view, std::int64_t y, std::int64_t z, mesh::Row& row) const;
  const mesh::Row& lower_row(const MeshScratch::RowPair& pair, std::int64_t y,
                             std::int64_t z) const;
  void make_rows(const LayerView& view, std::int64_t row, MeshScratch::RowPair& pair) const;
  bool is_crossed(std::int64_t y, std::int64_t z) const;
  bool has_triangles(std::int64_t y, std::int64_t z) const;
  void add_vertices(const LayerView& view, const RowRange& rows, mesh::MeshPiece& piece) const;
  void add_triangles(const LayerView& view, const RowRange& rows, MeshScratch& scratch,
                     mesh::MeshPiece& piece) const;

  const Plan& plan_;
  GridRegion region_;    // region of the mesh; rows are relative to it
  std::int64_t rows_y_;  // number of rows of a plane
  bool has_cells_;
  mesh::PieceContents contents_;
  VertexMaker make_vertex_;
  std::mutex mutex_;
  bool is_numbered_ = false;       // whether the rows of the current layer are numbered
  std::uint64_t layer_begin_ = 0;  // index of the first vertex of the current layer
  std::vector<std::uint64_t>
      row_begin_;                 // index of the first vertex of each row [z][y]; and the end
  std::vector<mesh::Row> below_;  // last plane of the previous layer, by y
};

}  // namespace eses::detail
