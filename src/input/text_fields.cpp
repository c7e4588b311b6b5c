#include "input/text_fields.hpp"

#include "eses/error.hpp"
#include "system/formatted.hpp"
#include "system/read_number.hpp"

namespace eses::detail {
namespace {

constexpr std::size_t max_quotation_length = 40;  // characters of input text in a message

std::errc outcome_of(std::string_view text, std::from_chars_result result) {
  if (result.ec == std::errc::invalid_argument || result.ptr != text.data() + text.size()) {
    return std::errc::invalid_argument;
  }
  return result.ec;
}

/// Parses a number with the exponent letter D of Fortran, which std::from_chars does not accept.
std::errc parse_fortran(std::string_view text, std::size_t exponent_letter, double& value) {
  std::string with_e(text);
  with_e[exponent_letter] = 'e';
  return outcome_of(with_e, read_number(with_e, value));
}

}  // namespace

std::string lower_case(std::string text) {
  for (char& c : text) c = lower_case(c);
  return text;
}

std::string upper_case(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 32);
  return text;
}

bool starts_with_ignoring_case(std::string_view text, std::string_view lower_case_prefix) {
  return text.size() >= lower_case_prefix.size() &&
         std::equal(lower_case_prefix.begin(), lower_case_prefix.end(), text.begin(),
                    [](char expected, char c) { return lower_case(c) == expected; });
}

std::string_view without_leading_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  return text;
}

std::string_view without_trailing_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view trimmed(std::string_view text) {
  return without_trailing_blanks(without_leading_blanks(text));
}

std::string_view column_text(std::string_view line, std::size_t first, std::size_t width) {
  return first >= line.size() ? std::string_view() : trimmed(line.substr(first, width));
}

std::string_view take_first(std::string_view& rest) {
  rest = without_leading_blanks(rest);
  std::size_t end = 0;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end);
  return field;
}

std::string_view take_last(std::string_view& rest) {
  rest = without_trailing_blanks(rest);
  std::size_t start = rest.size();
  while (start > 0 && !is_blank(rest[start - 1])) --start;
  const std::string_view field = rest.substr(start);
  rest.remove_suffix(field.size());
  return field;
}

bool has_word(std::string_view words, std::string_view word) {
  const auto is_end = [&](std::size_t i) { return i >= words.size() || is_blank(words[i]); };
  for (std::size_t at = words.find(word); at != words.npos; at = words.find(word, at + 1))
    if (!word.empty() && (at == 0 || is_end(at - 1)) && is_end(at + word.size())) return true;
  return false;
}

std::size_t count_fields(std::string_view text) {
  std::size_t count = 0;
  while (!take_first(text).empty()) ++count;
  return count;
}

std::errc parse_number(std::string_view text, double& value) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::errc::invalid_argument;
  }
  const std::from_chars_result result = read_number(text, value);
  const auto stop = static_cast<std::size_t>(result.ptr - text.data());
  if (stop < text.size() && (text[stop] == 'd' || text[stop] == 'D')) {
    return parse_fortran(text, stop, value);
  }
  return outcome_of(text, result);
}

void fail_at_line(std::string_view file, std::uint64_t line, std::string_view what) {
  throw Error(line == 0 ? formatted("{}: {}", file, what)
                        : formatted("{}:{}: {}", file, line, what));
}

std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c >= ' ' && c <= '~') {
      result += c;
    } else {
      result += formatted("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, max_quotation_length)) {
    if (c == '"' || c == '\\') result += '\\';
    result += printable({&c, 1});
  }
  result += '"';
  if (text.size() > max_quotation_length) result += "...";
  return result;
}

}  // namespace eses::detail
