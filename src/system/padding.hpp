#pragma once
/// Padding of arrays that vector loops process.

#include <cstddef>

namespace eses::detail {

/// Number of elements after the last one that a vector loop may read, or write back unchanged, in
/// arrays of doubles, 64-bit words or floats. It is the number of floats in the widest vector.
inline constexpr std::size_t vector_padding = 16;

}  // namespace eses::detail
