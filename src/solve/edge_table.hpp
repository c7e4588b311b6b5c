#pragma once
/// The edges of a block with one end inside and one outside.

#include <array>
#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"

namespace eses::detail {

/// Edges in canonical order: by lower point (z, y, x), then axis. `changes` and `rank` are indexed
/// like PointBits::words.
struct EdgeTable {
  std::array<std::vector<std::uint64_t>, 3> changes;  ///< by axis: bits of the edges' lower points
  std::vector<std::uint32_t> rank;  ///< number of edges before the first one of a word
  std::uint32_t count = 0;
};

}  // namespace eses::detail
