#pragma once
/// Room that vector loops need.

#include <cstddef>

namespace eses::detail {

/// Elements behind the last that a loop over vectors may read, and write back unchanged, in arrays
/// of doubles, 64-bit words or floats: as many as the widest vector holds.
inline constexpr std::size_t vector_padding = 16;

}  // namespace eses::detail
