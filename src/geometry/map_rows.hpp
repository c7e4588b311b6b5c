#pragma once
/// Rows of a map of grid points or grid edges.

#include <cstdint>
#include <vector>

namespace eses::detail {

/// The part of an edge that lies inside is a whole number of 1 / `whole_edge` of its length.
inline constexpr std::uint32_t whole_edge = 0xFFFF'FFFF;

/// An edge that is partly inside the surface.
struct PartialEdge {
  std::uint32_t row = 0;       ///< number in MapRows
  std::uint32_t x = 0;         ///< index in the row
  std::uint32_t fraction = 0;  ///< the part that lies inside, neither 0 nor `whole_edge`
};

/// Consecutive rows of a map along x. Each row begins with a new word: bit i % 64 of its word
/// i / 64 is point i, or whether edge i is wholly inside.
struct MapRows {
  std::vector<std::uint64_t> bits;
  std::vector<PartialEdge> partial_edges;  ///< their bits are 0

  void clear() {
    bits.clear();
    partial_edges.clear();
  }
};

}  // namespace eses::detail
