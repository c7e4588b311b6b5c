#pragma once
/// Padding of arrays that vector loops process, and of objects that threads write.

#include <cstddef>

namespace eses::detail {

/// Number of elements after the last one that a vector loop may read, or write back unchanged, in
/// arrays of doubles, 64-bit words or floats. It is the number of floats in the widest vector.
inline constexpr std::size_t vector_padding = 16;

/// Alignment in bytes of objects in an array that several threads write, so that they share no
/// cache line. Processors fetch lines in pairs.
inline constexpr std::size_t thread_alignment = 128;

}  // namespace eses::detail
