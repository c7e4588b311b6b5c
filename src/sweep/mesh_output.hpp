#pragma once
/// The mesh, from layers of blocks as they are written.

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "mesh/mesh_writer.hpp"
#include "mesh/triangulate.hpp"
#include "output/ordered_output.hpp"
#include "sweep/layer.hpp"
#include "sweep/text_chunks.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// What one thread needs to make a part of the mesh.
struct MeshScratch {
  /// Rows with the same y, of two planes.
  struct RowPair {
    mesh::Row lower, upper;
  };
  RowPair front, back;  ///< y and y + 1
  std::vector<mesh::Triangle> triangles;
  TextBuffer vertex_text, triangle_text;
  std::uint64_t triangle_count = 0;  ///< in all
};

/// Who gets the mesh: first the vertices of each part, then its triangles.
struct MeshSinks {
  OrderedOutput::WriteAt vertices;   ///< as text of the mesh's format
  OrderedOutput::WriteAt triangles;  ///< likewise, or as mesh::LocalTriangle
  bool has_local_triangles = false;
};

/// Cells between two planes are cut up when the upper plane is written. Of a layer that is done,
/// its last plane is kept. Of a region there are the cells whose lowest corner is in it, so that
/// regions that make up the grid have each cell once. Where there is no cell, there is no vertex
/// either.
class MeshOutput {
 public:
  /// The mesh of the cells that have all their corners in `corners`, or of the part of it that
  /// `plan.tiling` has. Keeps references to all but the sinks.
  MeshOutput(const Plan& plan, const GridRegion& region, const mesh::MeshText& text,
             MeshSinks sinks);

  /// One of `count` about equal parts.
  struct Share {
    std::int64_t index, count;
  };

  /// Writes chunk number `chunk`, a share of the layer's rows: vertices that start there, and the
  /// cells below and before them. Needs the far crossings of blocks. May be called from several
  /// threads, for chunks of one layer at a time; layers come in order, `release` between them.
  void write(const Layer& layer, std::int64_t chunk, const Share& share, MeshScratch& scratch);
  void release(const Layer& layer);
  /// Before anything is written: that the plane of this layer is the one below, whose vertices
  /// another part has.
  void go_on_from(const Layer& below);
  /// Releases all that wait, after a failure.
  void abandon();

  std::uint64_t vertex_count() const { return layer_begin_; }
  std::uint64_t vertex_bytes() const { return vertex_output_.size(); }
  std::uint64_t triangle_bytes() const { return triangle_output_.size(); }

 private:
  struct LayerView;

  std::int64_t planes_of(const Layer& layer) const;
  void number_rows(const Layer& layer);
  void make_row(const LayerView& view, std::int64_t y, std::int64_t z, mesh::Row& row) const;
  const mesh::Row& lower_row(const MeshScratch::RowPair& pair, std::int64_t y,
                             std::int64_t z) const;
  void make_rows(const LayerView& view, std::int64_t row, MeshScratch::RowPair& pair) const;
  bool is_crossed(std::int64_t y, std::int64_t z) const;
  bool has_triangles(std::int64_t y, std::int64_t z) const;
  void append_vertices(const LayerView& view, const RowRange& rows, TextBuffer& text) const;
  void append_triangles(const LayerView& view, const RowRange& rows, MeshScratch& scratch) const;

  const Plan& plan_;
  GridRegion region_;    // rows count from its first
  std::int64_t rows_y_;  // of a plane
  bool has_cells_;
  const mesh::MeshText& text_;
  bool has_local_triangles_;
  OrderedOutput vertex_output_, triangle_output_;
  std::mutex mutex_;
  bool is_numbered_ = false;              // the layer at hand
  std::uint64_t layer_begin_ = 0;         // number of its first vertex; before it, they wrap
  std::vector<std::uint64_t> row_begin_;  // of its rows [z][y], and one more
  std::vector<mesh::Row> below_;          // the last plane of the layer before, by y
};

}  // namespace eses::detail
