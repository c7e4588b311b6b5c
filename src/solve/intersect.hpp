#pragma once
/// Where the edges that a block owns cross the solvent excluded surface.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/point_bits.hpp"
#include "solve/crossing.hpp"

namespace eses {

/// The edges of a block whose ends differ, ranked in canonical order: by lower point (z, y, x),
/// then axis.
struct EdgeTable {
  std::array<std::vector<std::uint64_t>, 3> changes;  ///< per axis, indexed like PointBits
  std::vector<std::uint32_t> rank;                    ///< edges before word [z][y][column]
  std::int64_t columns = 0;
  GridIndex owned{};

  std::size_t rank_index(std::int64_t column, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * owned[1] + y) * columns + column);
  }
  std::uint32_t count() const { return rank.back(); }
};

struct IntersectScratch {
  struct Further {
    std::uint32_t edge;
    Candidate candidate;
  };
  EdgeTable edges;
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
