#pragma once
/// The division of the grid into blocks.
///
/// Blocks follow Zhao et al., "Divide-and-conquer strategy for large-scale Eulerian solvent
/// excluded surface", Commun. Inf. Syst. 18 (2018), arXiv:1809.04352. The block size is the number
/// of points on a side, including the face that the block shares with the next one.

#include <cstdint>

#include "eses/grid.hpp"

namespace eses::detail {

/// Number of grid points on a side of a block. The maximum limits the number of crossings of a
/// block.
inline constexpr std::int64_t min_block_size = 2;
inline constexpr std::int64_t default_block_size = 64;
inline constexpr std::int64_t max_block_size = 4096;

/// The points and edges of a block. The block classifies all points in [first, first + points). It
/// owns the points in [first, first + owned) and the edges that start there in +x, +y and +z.
struct BlockBounds {
  GridIndex first{};   ///< index of the block's lowest point in the grid
  GridIndex points{};  ///< number of points along each axis
  GridIndex owned{};   ///< number of owned points along each axis: `points`, or one less
};

/// The blocks of a region, usually the whole grid. Each point and each edge of the region is owned
/// by exactly one block. If the grid continues beyond the region, the last blocks have the next
/// plane of points as well, but do not own it.
struct BlockTiling {
  /// Number of points on the sides of a block along x, y and z.
  GridIndex block_size{default_block_size, default_block_size, default_block_size};
  GridIndex blocks{};           ///< number of blocks along x, y and z
  GridIndex grid_size{};        ///< number of points of the grid along x, y and z
  GridRegion region;            ///< points that blocks own
  GridRegion region_with_halo;  ///< see with_halo

  /// Returns the points that these blocks own. Throws std::invalid_argument if there are no such
  /// blocks.
  GridRegion points_of_blocks(const BlockRange& range) const;
  std::int64_t block_count() const { return blocks[0] * blocks[1] * blocks[2]; }
  BlockBounds block(std::int64_t bx, std::int64_t by, std::int64_t bz) const;

  /// Returns the block as if the region included the halo: the last blocks along an axis own the
  /// points of the halo and the edges between them.
  BlockBounds block_with_halo(std::int64_t bx, std::int64_t by, std::int64_t bz) const;
};

/// Returns a region and its halo: the corners of all cells whose lowest corner is in the region. So
/// the halo is the next plane of points along each axis if the grid, of this size, has one.
GridRegion with_halo(GridRegion region, const GridIndex& grid_size);

/// Divides a region that is not empty into cubes. There are `(n - 2) / (b - 1) + 1` blocks along an
/// axis with n points, for the block size b. Throws std::invalid_argument if `block_size` is not
/// between `min_block_size` and `max_block_size`.
BlockTiling make_tiling(const Grid& grid, std::int64_t block_size, const GridRegion& region);

/// Divides the whole grid into cubes.
BlockTiling make_tiling(const Grid& grid, std::int64_t block_size);

/// Divides a region into blocks with these numbers of points on the sides.
BlockTiling make_tiling(const Grid& grid, const GridIndex& block_size, const GridRegion& region);

}  // namespace eses::detail
