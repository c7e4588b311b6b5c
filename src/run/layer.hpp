#pragma once
/// One layer of blocks, solved, as rows of the whole grid.

#include <cstdint>
#include <vector>

#include "eses/tiling.hpp"
#include "solve/block_solver.hpp"

namespace eses {

struct Layer {
  std::vector<BlockResult> blocks;  ///< [by][bx]

  std::int64_t first_z() const { return blocks.front().block.first[2]; }
  std::int64_t owned_planes() const { return blocks.front().block.owned[2]; }
};

/// Words of a row of the whole grid: bit i % 64 of word i / 64 is point i.
using RowBits = std::vector<std::uint64_t>;

/// Where the pieces of a layer's rows stand in its blocks; made once for many rows.
class LayerRows {
 public:
  LayerRows(const BlockTiling& tiling, const Layer& layer);

  /// Joins the inside bits of row (y, z) from all blocks along x. `z` counts from the layer's first
  /// plane and may name the plane shared with the next layer.
  void join(std::int64_t y, std::int64_t z, RowBits& row) const;

 private:
  struct Piece {
    const std::uint64_t* words;  // [z][y] of one column of a block
    std::int64_t rows;           // of the block along y
    std::int64_t position;       // of its first point in the row
    std::int64_t count;          // of the points that it owns
  };

  const BlockTiling& tiling_;
  std::vector<std::vector<Piece>> pieces_;  // by block row
};

/// The rows of one plane of the whole grid, one after the other.
struct Plane {
  std::vector<RowBits> rows;  ///< by y; none before the first layer
};

/// All that is kept of a layer once it is written: the last plane that it owns.
Plane last_plane(const BlockTiling& tiling, const Layer& layer);

/// What the volume is made of.
struct PointCounts {
  std::int64_t inside = 0;          ///< inside points
  std::int64_t inside_regular = 0;  ///< of these, those that end no reported edge
  std::int64_t irregular = 0;       ///< points, inside or outside, that end one

  void add(const PointCounts& other);
};

/// Rows of a layer one after the other, [z][y], with the rows around them.
class RowWindow {
 public:
  /// `below` is the last plane of the layer before.
  RowWindow(const BlockTiling& tiling, const Plane& below, const Layer& layer);

  /// Moves to row (y, z), z from the layer's first plane; cheap if y is the next one.
  void move_to(std::int64_t y, std::int64_t z);
  const RowBits& row() const { return rows_[1]; }
  PointCounts count() const;

 private:
  void load(std::int64_t y, std::int64_t z, RowBits& row) const;

  const BlockTiling& tiling_;
  const Plane& below_;
  const Layer& layer_;
  LayerRows layer_rows_;
  std::int64_t y_ = -2, z_ = -1;
  RowBits rows_[3];    // y - 1, y, y + 1; the row itself where there is none
  RowBits planes_[2];  // z - 1 and z + 1, likewise
};

/// The part of the blocks in row y: their index range along x is [0, blocks[0]), all in block row
/// `by`, where y is the local row `y`.
struct BlockRow {
  std::int64_t by = 0, y = 0;
};
BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y);

}  // namespace eses
