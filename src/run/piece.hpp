#pragma once
/// Pieces of the results: a few rows of a layer as texts, words and numbers.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "input/atom_names.hpp"
#include "mesh/piece.hpp"
#include "output/eses_writer.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_file.hpp"
#include "output/text_buffer.hpp"
#include "run/layer.hpp"
#include "solve/block_solver.hpp"
#include "system/gzip.hpp"

namespace eses::detail {

/// The bytes of a piece for a file, and their offset in the file.
struct PieceText {
  TextBuffer buffer;
  std::uint64_t offset = 0;  ///< see Sink::place
};

/// The head of a piece in a chunk on disk.
struct PieceHead {
  std::uint32_t checksum = 0;        ///< crc32 of the following fields
  std::uint32_t lists_checksum = 0;  ///< crc32 of the lists
  std::int64_t first_row = 0;        ///< see RowPiece
  std::uint64_t vertex_count = 0;
  /// Length of each list in bytes: both texts, two lists of each map, and four of the mesh.
  std::array<std::uint64_t, 6 + 2 * map_quantities> bytes{};
};

/// The results of consecutive rows in canonical order.
struct RowPiece {
  PieceText grid, edges;                         ///< for grid_info.txt and intersection_info.txt
  std::int64_t first_row = 0;                    ///< number of the first row in the region
  std::array<MapRows, map_quantities> map_rows;  ///< by MapQuantity
  mesh::MeshPiece mesh;
  mesh::MeshFile::Texts mesh_texts;  ///< see RunFiles
  PieceHead head;                    ///< see ChunkFile
  std::uint64_t offset_in_chunk = 0;
};

/// Makes pieces from layers, without their meshes.
class PieceMaker {
 public:
  /// Scratch memory of a thread.
  struct Scratch {
    std::optional<Gzip> gzip;
  };

  /// The pieces have the texts and maps of `outputs`. Keeps references to `grid` and `tiling`.
  /// `file_indices` are those of the atoms.
  PieceMaker(const Grid& grid, const BlockTiling& tiling, const Outputs& outputs,
             FileIndices file_indices);

  /// The rows of the pieces.
  const RowBatches& batches() const { return batches_; }

  /// Makes the texts and map rows of these rows of a layer.
  void make(const Layer& layer, const RowRange& rows, Scratch& scratch, RowPiece& piece) const;

 private:
  void append_points(const Layer& layer, const RowRange& rows, TextBuffer& text) const;
  void append_crossings(const Layer& layer, const RowRange& rows, TextBuffer& text) const;
  void compress(TextBuffer& text, Scratch& scratch) const;

  const BlockTiling& tiling_;
  bool has_grid_, has_edges_;
  bool gzip_;  // whether both texts are members of gzip files
  std::vector<MapQuantity> maps_;
  GridText text_;
  RowBatches batches_;
};

}  // namespace eses::detail
