#pragma once
/// Formatting of numbers for the files of ESES.
///
/// write_scientific() gives the same digits as printf's %.12e. A number in [1e-9, 1e9) is
/// multiplied by a power of ten that is exact in double precision. The product has 13 digits before
/// the point, and an error of at most half a unit in the last place, which is less than 0.001. If
/// its fraction is not within 0.0015 of 1/2, rounding to the nearest integer is therefore correct.
/// All other numbers are formatted exactly by std::to_chars.

#include <cstddef>
#include <cstdint>

namespace eses::detail {

/// Maximum length of the text that the functions below write.
inline constexpr std::size_t max_number_length = 24;

/// Writes `value` with the same digits as printf's %.12e. Returns the end of the text.
char* write_scientific(char* out, double value);

/// Writes `value` in decimal digits. Returns the end of the text.
char* write_index(char* out, std::uint64_t value);

}  // namespace eses::detail
