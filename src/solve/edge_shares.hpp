#pragma once
/// How much of an edge lies inside the surface, however often the surface cuts it.

#include <cstdint>
#include <span>
#include <vector>

#include "grid/block_crossing.hpp"
#include "solve/intersect.hpp"

namespace eses::detail {

/// The parts of the edges of a block that lie inside, of all edges that are cut; an edge that is
/// not among these lies inside as a whole if both its ends do, and outside as a whole otherwise.
struct EdgeShares {
  struct Edge {
    std::uint32_t share = 0;  ///< of `whole_edge` parts
    std::uint16_t x = 0;      ///< of the edge's lower point, from the block's first point
    std::uint8_t axis = 0;
  };
  std::vector<Edge> edges;               ///< by lower point (z, y, x), then axis
  std::vector<std::uint32_t> row_begin;  ///< per row [z][y] of owned points, and one more
};

/// Finds the parts inside after intersect_edges, with which it shares `scratch`; that must have
/// found `doubtful` edges, too. `crossings` and `row_begin` are the results for the block of
/// `grid`, of which `owned` points are those whose edges count.
///
/// Along an edge the surface can only be where the edge's line meets a van der Waals sphere, the
/// tube around an arc or the sphere of a probe placement. All these places are found, and between
/// two that follow each other the definition decides for the point midway, so that places that are
/// none of the surface do no harm. An edge that meets only one patch that can be its crossing is
/// cut once, and needs none of this.
void find_edge_shares(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                      std::span<const BlockCrossing> crossings,
                      std::span<const std::uint32_t> row_begin, const GridIndex& owned,
                      IntersectScratch& scratch, EdgeShares& shares);

}  // namespace eses::detail
