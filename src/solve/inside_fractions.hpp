#pragma once
/// The fraction of each edge that lies inside the surface, for any number of crossings of the edge.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/block_crossing.hpp"
#include "solve/intersect.hpp"

namespace eses::detail {

/// The inside fractions of all edges of a block that the surface may cut. Any other edge is wholly
/// inside if both ends are inside, and wholly outside otherwise.
struct InsideFractions {
  struct Edge {
    std::uint32_t fraction = 0;  ///< inside fraction, in units of 1 / `whole_edge`
    std::uint16_t x = 0;  ///< x of the edge's lower point, relative to the block's first point
    std::uint8_t axis = 0;
  };
  std::vector<Edge> edges;               ///< by lower point (z, y, x), then axis
  std::vector<std::uint32_t> row_begin;  ///< first edge of each row [z][y], and the number of edges
};

/// Computes the inside fractions of the edges that start at the `owned` points of the block of
/// `grid`. `crossings`, `row_begin` and `scratch` are the results of intersect_edges, which must
/// have listed doubtful edges.
///
/// The surface can cut an edge only where the edge meets a van der Waals sphere, the tube around an
/// arc, or the sphere of a probe placement. All these points are computed. The midpoint between two
/// consecutive points decides by the definition of the surface whether the part between them is
/// inside, so points that are not on the surface do no harm. An edge that is not doubtful is cut
/// once, and its crossing gives the fraction.
void find_inside_fractions(const BlockGrid& grid, const BlockFeatures& features,
                           const PointBits& inside, std::span<const BlockCrossing> crossings,
                           std::span<const std::uint32_t> row_begin, const GridIndex& owned,
                           IntersectScratch& scratch, InsideFractions& fractions);

}  // namespace eses::detail
