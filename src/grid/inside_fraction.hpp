#pragma once
/// How the part of a grid edge that lies inside the surface is stored.

#include <cstddef>
#include <cstdint>

namespace eses::detail {

/// The part of an edge that lies inside is a whole number of 1 / `whole_edge` of its length.
inline constexpr std::uint32_t whole_edge = 0xFFFF'FFFF;

/// A word has the fractions of two neighbouring edges; its lower half belongs to the lower edge.
inline constexpr std::size_t fractions_per_word = 2;

/// Returns the fraction of an edge from the word that has it. Only the parity of `edge` matters.
inline std::uint32_t fraction_in(std::uint64_t word, std::size_t edge) {
  return static_cast<std::uint32_t>(word >> (edge % fractions_per_word * 32));
}

/// Replaces the fraction of an edge in the word that has it. Only the parity of `edge` matters.
inline void set_fraction(std::uint64_t& word, std::size_t edge, std::uint32_t fraction) {
  const std::size_t shift = edge % fractions_per_word * 32;
  word = (word & ~(std::uint64_t{whole_edge} << shift)) | std::uint64_t{fraction} << shift;
}

}  // namespace eses::detail
