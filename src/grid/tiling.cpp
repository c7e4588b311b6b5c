#include "eses/tiling.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "eses/error.hpp"

namespace eses {

BlockTiling make_tiling(const Grid& grid, std::int64_t block_size) {
  if (block_size < least_block_size || block_size > largest_block_size)
    throw Error(fmt::format("the block size must be between {} and {} grid points, not {}",
                            least_block_size, largest_block_size, block_size));
  BlockTiling tiling;
  tiling.block_size = block_size;
  tiling.grid_size = grid.size;
  for (std::size_t axis = 0; axis < 3; ++axis)
    // A single point, which has no cell, is a block all the same.
    tiling.blocks[axis] = (std::max<std::int64_t>(grid.size[axis], 2) - 2) / (block_size - 1) + 1;
  return tiling;
}

Block BlockTiling::block(std::int64_t bx, std::int64_t by, std::int64_t bz) const {
  const GridIndex position{bx, by, bz};
  Block block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_last = position[axis] == blocks[axis] - 1;
    block.first[axis] = position[axis] * (block_size - 1);
    block.points[axis] = std::min(block_size, grid_size[axis] - block.first[axis]);
    block.owned[axis] = is_last ? block.points[axis] : block_size - 1;
  }
  return block;
}

}  // namespace eses
