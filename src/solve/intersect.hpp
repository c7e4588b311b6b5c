#pragma once
/// Where the edges that a block owns cross the solvent excluded surface.

#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"
#include "solve/crossing.hpp"
#include "solve/edge_batch.hpp"
#include "solve/edge_table.hpp"

namespace eses::detail {

struct IntersectScratch {
  struct Further {
    std::uint32_t edge;
    bool needs_proof;  ///< see decide_crossing
    BlockCrossing candidate;
  };
  EdgeTable edges;
  EdgeBatch batch;
  PatchIndex patches;
  /// Of each edge, all candidates but the first that was found, and all that need a proof.
  std::vector<Further> further;
  std::vector<BlockCrossing> of_edge;  ///< candidates of the edge that is being decided
};

/// Appends the crossings in canonical order, and for each row (z, y) of owned points the number of
/// crossings before it to `row_begin` (rows + 1 entries).
void intersect_edges(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, std::vector<BlockCrossing>& crossings,
                     std::vector<std::uint32_t>& row_begin);

}  // namespace eses::detail
