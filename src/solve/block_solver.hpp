#pragma once
/// One block: atoms and patches in, points and crossings out. Knows no files and no threads.

#include <cstdint>
#include <vector>

#include "eses/crossing.hpp"
#include "grid/point_bits.hpp"
#include "solve/classify.hpp"
#include "solve/intersect.hpp"
#include "solve/tally.hpp"

namespace eses {

/// What a block contributes. Without any atom nearby `inside` has no words: all points are
/// outside.
struct BlockResult {
  Block block;
  PointBits inside;                      ///< of the closed box
  std::vector<Crossing> crossings;       ///< canonical order
  std::vector<std::uint32_t> row_begin;  ///< per row [z][y] of owned points, and one more
  double seconds = 0;                    ///< that solving it took
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

BlockResult solve_block(const Surface& surface, const Grid& grid, const Block& block,
                        BlockWorkspace& workspace);

}  // namespace eses
