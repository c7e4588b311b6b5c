#pragma once
/// A solved layer of blocks as rows of the whole grid.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/tiling.hpp"
#include "run/row_batches.hpp"
#include "run/solved_block.hpp"
#include "solve/block_solver.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// The results of a layer of blocks.
struct Layer {
  std::vector<BlockResult> blocks;  ///< [by][bx]

  std::int64_t first_z() const { return blocks.front().block.first[2]; }
  std::int64_t owned_planes() const { return blocks.front().block.owned[2]; }
};

/// The inside bits of a row of the region: bit i % 64 of word i / 64 is point i.
using RowBits = std::vector<std::uint64_t>;

/// The points of rows: the region, or BlockTiling::region_with_halo.
enum class Extent { region, with_halo };

/// An index of the parts of rows in the blocks of a layer, made once for many rows.
class LayerRows {
 public:
  LayerRows(const BlockTiling& tiling, const Layer& layer, Extent extent = Extent::region,
            PointBits BlockResult::*bits = &BlockResult::inside);

  /// Merges the bits, by default the inside points, of row (y, z) from all blocks along x. `y`
  /// is relative to the region's first row, `z` to the layer's first plane.
  void merge_row(std::int64_t y, std::int64_t z, RowBits& row) const;

 private:
  struct Part {
    const std::uint64_t* words;  // words [z][y] of one column of a block
    std::int64_t rows;           // number of rows of the block along y
    std::int64_t position;       // index of the first point in the row
    std::int64_t count;          // number of points that the column owns
  };

  const BlockTiling& tiling_;
  std::size_t words_;                     // of a row
  std::vector<std::vector<Part>> parts_;  // by block row
};

/// Returns the index along an axis of the block that owns a point. `offset` is relative to the
/// region's first point.
inline std::int64_t block_along(const BlockTiling& tiling, std::size_t axis, std::int64_t offset) {
  return std::min(offset / (tiling.block_size[axis] - 1), tiling.blocks[axis] - 1);
}

/// The position of a row in its blocks: the index `by` of the blocks along y, and the local index
/// `y` of the row in these blocks.
struct BlockRow {
  std::int64_t by = 0, y = 0;
};

/// Returns the position of row `y`, relative to the region's first row.
BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y);

/// An index of the blocks with crossings in a layer, made once for many rows.
class LayerCrossings {
 public:
  /// With the halo, rows have the crossings of the halo as well, and there are further rows.
  LayerCrossings(const BlockTiling& tiling, const Layer& layer, Extent extent = Extent::region);

  /// Calls `action(first_x, crossings)` for the parts of row (y, z), in the order of x. The `x` of
  /// a crossing is relative to `first_x`. `y` is relative to the region's first row, `z` to the
  /// layer's first plane.
  template <class Action>
  void for_each_row_part(std::int64_t y, std::int64_t z, Action&& action) const {
    const BlockRow row = block_row_of(tiling_, y);
    for (const BlockResult* const result : blocks_[static_cast<std::size_t>(row.by)]) {
      const auto act_on = [&](std::span<const BlockCrossing> part) {
        if (!part.empty()) action(result->block.first[0], part);
      };
      const auto& [first, points, owned] = result->block;
      if (row.y < owned[1] && z < owned[2])
        act_on(row_crossings(result->crossings, result->row_begin, z * owned[1] + row.y));
      if (extent_ == Extent::with_halo)
        act_on(
            row_crossings(result->halo_crossings, result->halo_row_begin, z * points[1] + row.y));
    }
  }

 private:
  const BlockTiling& tiling_;
  Extent extent_;
  std::vector<std::vector<const BlockResult*>> blocks_;  // by block row
};

/// The words of the rows of a plane of points with the halo, by y.
using Plane = std::vector<std::uint64_t>;

/// Returns the last plane that a layer owns, which is kept when the layer has been written.
Plane last_plane(const BlockTiling& tiling, const Layer& layer);

/// Counts the points of these rows of a layer. `below` is the last plane of the previous layer,
/// empty if there is none.
PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         const RowRange& rows);

}  // namespace eses::detail
