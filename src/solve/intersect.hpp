#pragma once
/// Where the edges that a block owns cross the solvent excluded surface.

#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"
#include "solve/crossing.hpp"
#include "solve/edge_batch.hpp"
#include "solve/edge_table.hpp"

namespace eses {

struct IntersectScratch {
  struct Further {
    std::uint32_t edge;
    Candidate candidate;
  };
  EdgeTable edges;
  EdgeBatch batch;
  std::vector<Candidate> first;    ///< per edge, the first candidate found
  std::vector<Further> further;    ///< all others
  std::vector<Candidate> of_edge;  ///< of the edge that is being decided
};

/// Appends the crossings in canonical order, and for each row (z, y) of owned points the number of
/// crossings before it to `row_begin` (rows + 1 entries).
void intersect_edges(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, std::vector<Crossing>& crossings,
                     std::vector<std::uint32_t>& row_begin);

}  // namespace eses
