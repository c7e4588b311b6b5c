#pragma once
/// Where the edges that a block owns cross the solvent excluded surface.

#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"
#include "solve/crossing.hpp"
#include "solve/edge_batch.hpp"
#include "solve/edge_table.hpp"

namespace eses::detail {

/// An edge that the surface may cut more than once, or that has ends on one side and may be cut.
struct DoubtfulEdge {
  std::uint32_t row = 0;  ///< [z][y] of the block's owned points
  std::uint16_t x = 0;    ///< of its lower point, from the block's first point
  std::uint8_t axis = 0;
};

struct IntersectScratch {
  struct Further {
    std::uint32_t edge;
    bool needs_proof;  ///< see decide_crossing
    Crossing candidate;
  };
  EdgeTable edges;
  EdgeBatch batch;
  PatchIndex patches;
  /// Of each edge, all candidates but the first that was found, and all that need a proof.
  std::vector<Further> further;
  /// Whether doubtful edges are to be found, and those found, in any order, perhaps several times.
  bool finds_doubtful = false;
  std::vector<DoubtfulEdge> doubtful;
  std::vector<double> places;     ///< of find_edge_shares
  std::vector<Crossing> of_edge;  ///< candidates of the edge that is being decided
};

/// Appends the crossings in canonical order, and for each row (z, y) of owned points the number of
/// crossings before it to `row_begin` (rows + 1 entries).
void intersect_edges(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, std::vector<Crossing>& crossings,
                     std::vector<std::uint32_t>& row_begin);

}  // namespace eses::detail
