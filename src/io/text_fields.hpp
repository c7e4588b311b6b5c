#pragma once
/// Fields of a line of text, parted by blanks and tabs, and the numbers that they spell.

#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

namespace eses::detail {

/// A text line longer than this holds none of our data; it bounds what is looked at for one
/// message.
inline constexpr std::size_t longest_line = 4096;  // characters

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
/// Of ASCII only: the locale must not matter.
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
std::string lower_case(std::string text);

std::string_view without_leading_blanks(std::string_view text);
std::string_view without_trailing_blanks(std::string_view text);

/// Removes the first, or last, field from `rest`; empty if there is none.
std::string_view take_first(std::string_view& rest);
std::string_view take_last(std::string_view& rest);

/// The number that `text` spells from its first to its last character, in any of the ways that C
/// and Fortran print one: with a leading `+`, with a D for the exponent, as `inf` or `nan`. Else
/// std::errc::invalid_argument or, beyond double precision, std::errc::result_out_of_range.
std::errc parse_number(std::string_view text, double& value);

/// Printable ASCII for messages; other bytes become `\xNN`.
std::string printable(std::string_view text);

/// For messages: whatever the file holds, the result is short, printable ASCII.
std::string quoted(std::string_view text);

}  // namespace eses::detail
