#include "geometry/tiling.hpp"

#include <algorithm>
#include <stdexcept>

#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail {

GridRegion with_halo(GridRegion region, const GridIndex& grid_size) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    region.end[axis] = std::min(region.end[axis] + 1, grid_size[axis]);
  return region;
}

BlockTiling make_tiling(const Grid& grid, std::int64_t block_size) {
  return make_tiling(grid, block_size, grid.whole());
}

BlockTiling make_tiling(const Grid& grid, std::int64_t block_size, const GridRegion& region) {
  return make_tiling(grid, {block_size, block_size, block_size}, region);
}

BlockTiling make_tiling(const Grid& grid, const GridIndex& block_size, const GridRegion& region) {
  for (const std::int64_t side : block_size)
    if (side < min_block_size || side > max_block_size)
      throw std::invalid_argument(
          formatted("the block size must be between {} and {} grid points, not {}", min_block_size,
                    max_block_size, side));
  BlockTiling tiling;
  tiling.block_size = block_size;
  tiling.grid_size = grid.size;
  tiling.region = region;
  tiling.region_with_halo = with_halo(region, grid.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t points = region.end[axis] - region.begin[axis];
    const std::int64_t shared = region.end[axis] < grid.size[axis] ? 1 : 0;
    // A single plane of points, which has no cells, is one block.
    tiling.blocks[axis] =
        (std::max<std::int64_t>(points + shared, 2) - 2) / (block_size[axis] - 1) + 1;
  }
  return tiling;
}

GridRegion BlockTiling::points_of_blocks(const BlockRange& range) const {
  GridRegion points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t begin = range.begin[axis], end = range.end[axis];
    if (begin < 0 || begin >= end || end > blocks[axis])
      throw HintedArgument(
          formatted(
              "block range {}:{} along {} must be within 0:{} (blocks of {} points on a side)",
              begin, end, "xyz"[axis], blocks[axis], block_size[axis]),
          {"blocks"});
    points.begin[axis] = region.begin[axis] + begin * (block_size[axis] - 1);
    points.end[axis] =
        end == blocks[axis] ? region.end[axis] : region.begin[axis] + end * (block_size[axis] - 1);
  }
  return points;
}

BlockBounds BlockTiling::block(std::int64_t bx, std::int64_t by, std::int64_t bz) const {
  const GridIndex position{bx, by, bz};
  BlockBounds block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.first[axis] = region.begin[axis] + position[axis] * (block_size[axis] - 1);
    const std::int64_t last = std::min(region.end[axis], grid_size[axis] - 1);
    block.points[axis] = std::min(block_size[axis], last - block.first[axis] + 1);
    const bool is_last = position[axis] == blocks[axis] - 1;
    block.owned[axis] = is_last ? region.end[axis] - block.first[axis] : block_size[axis] - 1;
  }
  return block;
}

BlockBounds BlockTiling::block_with_halo(std::int64_t bx, std::int64_t by, std::int64_t bz) const {
  const GridIndex position{bx, by, bz};
  BlockBounds wider = block(bx, by, bz);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (position[axis] == blocks[axis] - 1)
      wider.owned[axis] = region_with_halo.end[axis] - wider.first[axis];
  return wider;
}

}  // namespace eses::detail
