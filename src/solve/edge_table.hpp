#pragma once
/// The edges of a block whose ends differ.

#include <array>
#include <cstdint>
#include <vector>

#include "grid/point_bits.hpp"

namespace eses::detail {

/// Edges are ranked in canonical order: by lower point (z, y, x), then axis.
struct EdgeTable {
  std::array<std::vector<std::uint64_t>, 3> changes;  ///< per axis, indexed like PointBits::words
  std::vector<std::uint32_t> rank;                    ///< edges before a word's first, likewise
  std::uint32_t count = 0;
};

}  // namespace eses::detail
