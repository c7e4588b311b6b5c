#pragma once
/// Formatting of numbers for the files of ESES.
///
/// write_scientific() gives the same digits as printf's %.12e. A number in [1e-9, 1e9) is
/// multiplied by a power of ten that is exact in double precision. The product has 13 digits before
/// the point, and an error of at most half a unit in the last place, which is less than 0.001. If
/// its fraction is not within 0.0015 of 1/2, rounding to the nearest integer is therefore correct.
/// All other numbers are formatted exactly by std::to_chars.
///
/// The digits of the integer are extracted by repeated halving, as in W. Mula, "SSE: conversion
/// integers to decimal representation", 2011, http://0x80.pl/articles/sse-itoa.html.

#include <array>
#include <cstddef>
#include <cstdint>

namespace eses::detail {

/// Maximum length of the text that the functions below write.
inline constexpr std::size_t max_number_length = 24;

/// Writes `value` with the same digits as printf's %.12e. Returns the end of the text.
char* write_scientific(char* out, double value);

/// Numbers that are formatted together.
struct NumberBatch {
  static constexpr std::size_t capacity = 64;

  std::array<double, capacity> values;
  std::array<double, capacity> scaled;           ///< scaled to 13 digits before the point
  std::array<std::uint64_t, capacity> leading;   ///< text of the first five digits, with the point
  std::array<std::uint64_t, capacity> trailing;  ///< text of the last eight digits
  std::array<std::array<char, 4>, capacity> power;  ///< text of the power of ten
  std::uint64_t needs_exact = 0;                    ///< bit i: number i needs write_scientific()
  std::size_t count = 0;

  void add(double value);
};

/// Computes the digits of all numbers.
void make_digits(NumberBatch& batch);

/// Writes number `i` with the same bytes as write_scientific(). Returns the end of the text.
char* write_number(char* out, const NumberBatch& batch, std::size_t i);

/// Writes `value` in decimal digits. Returns the end of the text.
char* write_index(char* out, std::uint64_t value);

}  // namespace eses::detail
