#pragma once
/// Numbers as ESES's files have them, written into memory by tables.

#include <cstddef>
#include <cstdint>

namespace eses {

/// The longest text that the functions below write.
inline constexpr std::size_t longest_number_text = 24;

/// `value` as printf's %.12e, digit for digit; returns the end.
char* write_scientific(char* out, double value);

/// `value` >= 0 in decimal digits; returns the end.
char* write_index(char* out, std::uint64_t value);

}  // namespace eses
