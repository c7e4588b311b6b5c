#pragma once
/// Permutations that move selected elements of a vector to its front.

#include <array>
#include <cstddef>
#include <cstdint>

namespace eses::detail {

/// For each set of `element_count` elements, given as bits, the parts of its elements in ascending
/// order. Each element has `parts` parts.
template <class Index, std::size_t element_count, std::size_t parts>
using SelectionTable = std::array<std::array<Index, element_count * parts>, 1 << element_count>;

template <class Index, std::size_t element_count, std::size_t parts>
constexpr SelectionTable<Index, element_count, parts> make_selection_table() {
  SelectionTable<Index, element_count, parts> table{};
  for (std::size_t set = 0; set < table.size(); ++set) {
    std::size_t next = 0;
    for (std::size_t part = 0; part < element_count * parts; ++part)
      if ((set >> (part / parts) & 1) != 0) table[set][next++] = static_cast<Index>(part);
  }
  return table;
}

/// The bytes of 8 elements of 16 bits.
inline constexpr auto selected_bytes = make_selection_table<std::uint8_t, 8, 2>();

/// The bytes of 4 elements of 32 bits.
inline constexpr auto selected_bytes_of_words = make_selection_table<std::uint8_t, 4, 4>();

/// The numbers of 8 elements.
inline constexpr auto selected_lanes = make_selection_table<std::uint8_t, 8, 1>();

/// The 32-bit words of 4 elements of 64 bits.
inline constexpr auto selected_words = make_selection_table<std::uint32_t, 4, 2>();

}  // namespace eses::detail
