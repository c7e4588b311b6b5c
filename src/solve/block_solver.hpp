#pragma once
/// Solution of one block: from atoms and patches to inside points and crossings. It uses neither
/// files nor threads.

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/block_crossing.hpp"
#include "geometry/point_bits.hpp"
#include "solve/classify.hpp"
#include "solve/filled_points.hpp"
#include "solve/inside_fractions.hpp"
#include "solve/intersect.hpp"
#include "solve/tally.hpp"

namespace eses::detail {

/// Optional results of a block besides its points and crossings.
struct BlockExtras {
  bool inside_fractions = false;  ///< whether to compute BlockResult::fractions
  /// Whether results keep their crossings after they were passed on. If not, their memory serves
  /// the next block. See BlockWorkspace::recycle_crossings.
  bool keeps_crossings = true;
  std::optional<double> ion_radius;  ///< radius of the ions for BlockResult::covered (angstrom)
};

/// The result of a block.
struct BlockResult {
  BlockBounds block;
  PointBits inside;  ///< all points of the block; without words if no atom is near
  std::vector<BlockCrossing> crossings;  ///< crossings of owned edges, in canonical order
  /// Index of the first crossing of each row [z][y] of owned points, and the number of crossings.
  /// Empty if no atom is near.
  std::vector<std::uint32_t> row_begin;
  /// Crossings of edges in the halo of the region, which no block owns. See solve_block_for_mesh.
  std::vector<BlockCrossing> halo_crossings;
  /// Like `row_begin` for the halo crossings, by row [z][y] of all points; empty if there is no
  /// halo.
  std::vector<std::uint32_t> halo_row_begin;
  InsideFractions
      fractions;       ///< inside lengths of the owned edges; empty unless BlockExtras has them
  PointBits covered;   ///< points without ion access; no words unless BlockExtras has an ion radius
  double seconds = 0;  ///< time to solve the block

  /// Returns the memory in bytes of the result of a block with this number of points, without
  /// crossings.
  static double memory_bytes(const GridIndex& points, const BlockExtras& extras);
  /// Returns the memory in bytes that is kept for a crossing.
  static double kept_crossing_bytes(const BlockExtras& extras);
};

/// Scratch memory and sums of one thread.
struct BlockWorkspace {
  /// Crossings and rows of a result.
  struct CrossingLists {
    std::vector<BlockCrossing> crossings;
    std::vector<std::uint32_t> row_begin;
  };

  /// Returns the estimated memory in bytes of all threads.
  static double memory_bytes(const SurfaceSurvey& survey, const Grid& grid,
                             const BlockTiling& tiling, int threads);

  BlockExtras extras;
  BlockGrid grid;
  BlockFeatures features;
  ClassifyScratch classify;
  FilledScratch filled;
  IntersectScratch intersect;
  Tally tally;
  CrossingLists spare;  ///< memory for the lists of the next result
  double classify_seconds = 0;
  double intersect_seconds = 0;

  /// Drops the crossings of a result, and keeps their memory for the next result.
  void recycle_crossings(BlockResult& result);
};

/// Solves a block, and adds its crossings to the sums of the workspace. The clusters of all atoms
/// near the block must be complete.
BlockResult solve_block(const Patches& patches, const Grid& grid, const BlockBounds& block,
                        BlockWorkspace& workspace);

/// Does the same, and finds the halo crossings: the crossings that are owned by `wider`, the same
/// block with more owned points, but not by `block`. They are not added to the sums.
BlockResult solve_block_for_mesh(const Patches& patches, const Grid& grid, const BlockBounds& block,
                                 const BlockBounds& wider, BlockWorkspace& workspace);

}  // namespace eses::detail
