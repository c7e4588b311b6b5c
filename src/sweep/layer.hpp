#pragma once
/// One layer of blocks, solved, as rows of the whole grid.

#include <cstdint>
#include <span>
#include <vector>

#include "grid/tiling.hpp"
#include "solve/block_solver.hpp"

namespace eses::detail {

struct Layer {
  std::vector<BlockResult> blocks;  ///< [by][bx]

  std::int64_t first_z() const { return blocks.front().block.first[2]; }
  std::int64_t owned_planes() const { return blocks.front().block.owned[2]; }
};

/// Words of a row of the whole grid, or of the region that is computed: bit i % 64 of word i / 64
/// is point i.
using RowBits = std::vector<std::uint64_t>;

/// Which of a layer's points are meant: those of the region, or also the far corners, for which see
/// BlockTiling::region_with_halo.
enum class Extent { region, with_halo };

/// Where the parts of a layer's rows stand in its blocks; made once for many rows.
class LayerRows {
 public:
  LayerRows(const BlockTiling& tiling, const Layer& layer, Extent extent = Extent::region);

  /// Merges the inside bits of row (y, z) from all blocks along x. `y` counts from the region's
  /// first row, `z` from the layer's first plane.
  void merge_row(std::int64_t y, std::int64_t z, RowBits& row) const;

 private:
  struct Part {
    const std::uint64_t* words;  // [z][y] of one column of a block
    std::int64_t rows;           // of the block along y
    std::int64_t position;       // of its first point in the row
    std::int64_t count;          // of the points that it owns
  };

  const BlockTiling& tiling_;
  std::size_t words_;                     // of a row
  std::vector<std::vector<Part>> parts_;  // by block row
};

/// The part of the blocks in row y: their index range along x is [0, blocks[0]), all in block row
/// `by`, where y is the local row `y`.
struct BlockRow {
  std::int64_t by = 0, y = 0;
};
BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y);

/// Which of a layer's blocks have crossings; made once for many rows.
class LayerCrossings {
 public:
  LayerCrossings(const BlockTiling& tiling, const Layer& layer);

  /// Calls action(first_x, crossings) for the parts of row (y, z), by x; a crossing's `x` counts
  /// from `first_x`, `z` from the layer's first plane.
  template <class Action>
  void for_each_row_part(std::int64_t y, std::int64_t z, Action&& action) const {
    const BlockRow place = block_row_of(tiling_, y);
    for (const BlockResult* const result : blocks_[static_cast<std::size_t>(place.by)])
      act_on(*result, owned_part(*result, place.y, z), action);
  }

  /// The same with those of the edges between far corners, among which there are further rows.
  template <class Action>
  void for_each_row_part_with_halo(std::int64_t y, std::int64_t z, Action&& action) const {
    const BlockRow place = block_row_of(tiling_, y);
    for (const BlockResult* const result : blocks_[static_cast<std::size_t>(place.by)]) {
      act_on(*result, owned_part(*result, place.y, z), action);
      act_on(*result, halo_part(*result, place.y, z), action);
    }
  }

 private:
  template <class Action>
  static void act_on(const BlockResult& result, std::span<const BlockCrossing> part,
                     Action& action) {
    if (!part.empty()) action(result.block.first[0], part);
  }
  static std::span<const BlockCrossing> owned_part(const BlockResult& result, std::int64_t y,
                                                   std::int64_t z);
  static std::span<const BlockCrossing> halo_part(const BlockResult& result, std::int64_t y,
                                                  std::int64_t z);

  const BlockTiling& tiling_;
  std::vector<std::vector<const BlockResult*>> blocks_;  // by block row
};

/// The inside bits of the last plane that a layer owns: all that is kept of it once it is written.
/// By block [by][bx], words [column][y]; none where there is no layer or nothing inside.
struct Plane {
  std::vector<std::vector<std::uint64_t>> blocks;
};

Plane last_plane(const Layer& layer);

}  // namespace eses::detail
