#pragma once
/// The tiling of the grid into blocks, usually cubes, and which block owns what.
///
/// Zhao et al., "Divide-and-conquer strategy for large-scale Eulerian solvent excluded surface",
/// Commun. Inf. Syst. 18 (2018). Block size `b` counts points on a side, the face shared with the
/// next block included.

#include <cstdint>

#include "eses/grid.hpp"

namespace eses::detail {

/// Grid points on a side of a block; the largest bounds what a block's crossings can number.
inline constexpr std::int64_t min_block_size = 2;
inline constexpr std::int64_t default_block_size = 64;
inline constexpr std::int64_t max_block_size = 4096;

/// One block: the closed box of points [first, first + points), of which it owns the half-open
/// part [first, first + owned) and the edges that start there in +x, +y and +z.
struct BlockBounds {
  GridIndex first{};   ///< global index of its lowest point
  GridIndex points{};  ///< points of the closed box along each axis
  GridIndex owned{};   ///< points owned along each axis: `points`, or one less
};

/// The blocks of a region, usually the whole grid. The last ones along an axis end with the region:
/// of the point behind it they know, but own it no more than blocks own the face that they share.
struct BlockTiling {
  /// Points on the sides of a block along x, y and z.
  GridIndex block_size{default_block_size, default_block_size, default_block_size};
  GridIndex blocks{};     ///< number of blocks along x, y and z
  GridIndex grid_size{};  ///< points of the grid along x, y and z
  GridRegion region;      ///< the points that blocks own
  /// The corners of all cells that belong to the region: for make_tiling those whose lowest corner
  /// is in it, so that there are also the points behind its last ones, as far as the grid has them.
  GridRegion region_with_halo;

  /// The points that blocks [begin, end) own. Throws Error if there are no such blocks.
  GridRegion points_of_blocks(const GridRegion& indices) const;
  std::int64_t block_count() const { return blocks[0] * blocks[1] * blocks[2]; }
  BlockBounds block(std::int64_t bx, std::int64_t by, std::int64_t bz) const;

  /// The same block as it would be if the grid ended with `corners`: the last ones along an axis
  /// own the far corners, too, and so the edges between them.
  BlockBounds block_with_halo(std::int64_t bx, std::int64_t by, std::int64_t bz) const;
};

/// The region in cubes: `(n - 2) / (b - 1) + 1` blocks along each axis, the first of which begins
/// with the region, which is not empty. Throws Error if `block_size` is below `min_block_size` or
/// above `max_block_size`.
BlockTiling make_tiling(const Grid& grid, std::int64_t block_size, const GridRegion& region);

/// The same for the whole grid.
BlockTiling make_tiling(const Grid& grid, std::int64_t block_size);

/// The same in blocks whose sides differ.
BlockTiling make_tiling(const Grid& grid, const GridIndex& block_size, const GridRegion& region);

}  // namespace eses::detail
