#pragma once
/// Fields of a line of text, separated by blanks and tabs, and their numbers. This header is valid
/// C++17, for the reason given in mmcif_text.cpp.

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace eses::detail {

/// Maximum length of a line. Longer lines are rejected, which bounds the text that is searched for
/// a message.
inline constexpr std::size_t max_line_length = 4096;  // characters

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
/// Converts ASCII letters to lower case, independently of the locale.
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
std::string lower_case(std::string text);
std::string upper_case(std::string text);

bool starts_with_ignoring_case(std::string_view text, std::string_view lower_case_prefix);

std::string_view without_leading_blanks(std::string_view text);
std::string_view without_trailing_blanks(std::string_view text);
/// Returns the text without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Removes the first line from `rest` and returns it without its end: LF, or LF after carriage
/// returns. The last line may lack the LF.
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// Returns the text of `width` columns from `first` on, from 0, without blanks around it. The line
/// may end before them.
std::string_view column_text(std::string_view line, std::size_t first, std::size_t width);

/// Removes the first or last field from `rest` and returns it; empty if there is none.
std::string_view take_first(std::string_view& rest);
std::string_view take_last(std::string_view& rest);

/// Returns whether a list of words, separated by blanks, has this word.
bool has_word(std::string_view words, std::string_view word);

/// Returns the number of fields.
std::size_t count_fields(std::string_view text);

/// Parses a number that is the whole of `text`. Accepts all formats that C and Fortran print: with
/// a leading `+`, with the exponent letter D, and `inf` or `nan`. Returns
/// std::errc::invalid_argument for other text, and std::errc::result_out_of_range if double
/// precision is exceeded.
std::errc parse_number(std::string_view text, double& value);

/// Parses `text` as an integer. Returns false if it has other characters.
template <class Integer>
bool parse_integer(std::string_view text, Integer& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

/// Throws Error with file, line and what is wrong. The line is from 1; 0 if it is unknown.
[[noreturn]] void fail_at_line(std::string_view file, std::uint64_t line, std::string_view what);

/// Returns printable ASCII for messages; other bytes become `\xNN`.
std::string printable(std::string_view text);

/// Returns a quotation for messages: short, printable ASCII for any input.
std::string quoted(std::string_view text);

}  // namespace eses::detail
