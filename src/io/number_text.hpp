#pragma once
/// Numbers as ESES's files have them, written into memory by tables.

#include <array>
#include <cstddef>
#include <cstdint>

namespace eses::detail {

/// The longest text that the functions below write.
inline constexpr std::size_t longest_number_text = 24;

/// `value` as printf's %.12e, digit for digit; returns the end.
char* write_scientific(char* out, double value);

/// Numbers on their way into text, worked on together.
struct NumberBatch {
  static constexpr std::size_t capacity = 64;

  std::array<double, capacity> values;
  std::array<double, capacity> scaled;              ///< to 13 digits before the point
  std::array<std::uint64_t, capacity> leading;      ///< text of five digits, with the point
  std::array<std::uint64_t, capacity> trailing;     ///< text of the other eight
  std::array<std::array<char, 4>, capacity> power;  ///< text of the power of ten
  std::uint64_t needs_exact = 0;                    ///< bit i: number i needs write_scientific()
  std::size_t count = 0;

  void add(double value);
};

/// Makes the digits of all numbers.
void make_digits(NumberBatch& batch);

/// Writes number `i`, byte for byte as write_scientific() does; returns the end.
char* write_number(char* out, const NumberBatch& batch, std::size_t i);

/// `value` >= 0 in decimal digits; returns the end.
char* write_index(char* out, std::uint64_t value);

}  // namespace eses::detail
