#pragma once
/// Crossings of the edges that a block owns with the solvent excluded surface.

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/point_bits.hpp"
#include "solve/crossing.hpp"
#include "solve/edge_batch.hpp"
#include "solve/edge_table.hpp"
#include "solve/tally.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// An edge that the surface may cut more than once, or an edge with both ends on one side that the
/// surface may cut.
struct DoubtfulEdge {
  std::uint32_t row = 0;  ///< row [z][y] of the block's owned points
  std::uint16_t x = 0;    ///< x of its lower point, relative to the block's first point
  std::uint8_t axis = 0;
};

/// Scratch memory of intersect_edges.
struct IntersectScratch {
  /// A candidate for the crossing of an edge.
  struct Candidate {
    std::uint32_t edge;  ///< index of the edge in canonical order
    bool needs_proof;    ///< see decide_crossing
    BlockCrossing crossing;
  };
  EdgeTable edges;
  EdgeBatch batch;
  std::array<std::uint64_t, EdgeBatch::capacity + vector_padding> codes{};  ///< see EdgeCodes
  PatchIndex patches;
  /// All candidates of each edge except the first one, and all candidates that need a proof.
  std::vector<Candidate> more_candidates;
  bool finds_doubtful = false;         ///< whether to list doubtful edges
  std::vector<DoubtfulEdge> doubtful;  ///< in any order, with repetitions
  std::vector<double> cuts;            ///< scratch memory of find_inside_fractions
  std::vector<BlockCrossing> of_edge;  ///< candidates of the current edge
};

/// Appends the crossings to `crossings` in canonical order, and adds them to the tally. Appends to
/// `row_begin` the number of crossings before each row (z, y) of owned points, and finally the
/// total number.
void intersect_edges(const SurfaceModel& surface, const BlockGrid& grid,
                     const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, Tally& tally, std::vector<BlockCrossing>& crossings,
                     std::vector<std::uint32_t>& row_begin);

}  // namespace eses::detail
