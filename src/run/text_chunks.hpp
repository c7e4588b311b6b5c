#pragma once
/// How a layer's rows are cut into chunks of text.

#include <algorithm>
#include <cstdint>

#include "eses/grid.hpp"

namespace eses {

/// Rows of the grid that one thread turns into text at a time.
inline std::int64_t rows_per_chunk(const Grid& grid) {
  constexpr std::int64_t text_bytes = 1 << 19;
  constexpr std::int64_t line_bytes = 16;
  return std::max<std::int64_t>(1, text_bytes / (line_bytes * grid.size[0]));
}

}  // namespace eses
