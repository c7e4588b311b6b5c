#pragma once
/// One block: atoms and patches in, points and crossings out. Knows no files and no threads.

#include <cstdint>
#include <vector>

#include "grid/block_crossing.hpp"
#include "grid/point_bits.hpp"
#include "solve/classify.hpp"
#include "solve/intersect.hpp"
#include "solve/tally.hpp"

namespace eses::detail {

/// What a block contributes. Without any atom nearby `inside` has no words: all points are
/// outside.
struct BlockResult {
  BlockBounds block;
  PointBits inside;                      ///< of the closed box
  std::vector<BlockCrossing> crossings;  ///< canonical order
  std::vector<std::uint32_t> row_begin;  ///< per row [z][y] of owned points, and one more
  /// Of edges between points that the block knows, but nobody owns: see solve_block_for_mesh.
  std::vector<BlockCrossing> halo_crossings;
  std::vector<std::uint32_t> halo_row_begin;  ///< per row [z][y] of all points; or empty
  double seconds = 0;                         ///< that solving it took
};

/// Scratch memory and sums of one thread.
struct BlockWorkspace {
  BlockGrid grid;
  BlockFeatures features;
  ClassifyScratch classify;
  IntersectScratch intersect;
  Tally tally;
  double classify_seconds = 0;
  double intersect_seconds = 0;
};

BlockResult solve_block(const Patches& patches, const Grid& grid, const BlockBounds& block,
                        BlockWorkspace& workspace);

/// The same, with the far crossings: those that `wider` owns besides, which is the same block with
/// more owned points. They count for nothing else.
BlockResult solve_block_for_mesh(const Patches& patches, const Grid& grid, const BlockBounds& block,
                                 const BlockBounds& wider, BlockWorkspace& workspace);

}  // namespace eses::detail
