#include "system/read_number.hpp"

#ifndef __cpp_lib_to_chars
#include <locale.h>
#include <stdlib.h>
#if __has_include(<xlocale.h>)  // macOS and BSD
#include <xlocale.h>
#endif

#include <cmath>
#include <cstddef>
#include <string>
#endif

namespace eses::detail {

#ifdef __cpp_lib_to_chars

std::from_chars_result read_number(std::string_view text, double& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value);
}

#else

namespace {

// Returns the length of the decimal number without sign at the beginning of `text`, or 0.
std::size_t decimal_length(std::string_view text) {
  const auto digits_end = [text](std::size_t end) {
    while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
    return end;
  };
  std::size_t end = digits_end(0);
  const bool has_point = end < text.size() && text[end] == '.';
  if (has_point) end = digits_end(end + 1);
  if (end == (has_point ? 1 : 0)) return 0;
  if (end == text.size() || (text[end] != 'e' && text[end] != 'E')) return end;
  const std::size_t sign = end + 1;
  const bool has_sign = sign < text.size() && (text[sign] == '+' || text[sign] == '-');
  const std::size_t exponent = has_sign ? sign + 1 : sign;
  const std::size_t exponent_end = digits_end(exponent);
  return exponent_end > exponent ? exponent_end : end;
}

// Returns whether a decimal number is not zero, so that a value of 0 or infinity is out of range.
bool has_digits(std::string_view decimal) {
  return decimal.find_first_of("123456789") < decimal.find_first_of("eE");
}

}  // namespace

// Converts with strtod(3) what std::from_chars accepts: no blanks, no leading `+`, and no
// hexadecimal numbers. The point does not depend on the locale of the process.
std::from_chars_result read_number(std::string_view text, double& value) {
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string_view unsigned_text = text.substr(text.starts_with('-') ? 1 : 0);
  const bool is_word =
      !unsigned_text.empty() && std::string_view("iInN").find(unsigned_text[0]) != text.npos;
  const std::size_t length = is_word ? unsigned_text.size() : decimal_length(unsigned_text);
  const std::string number(text.data(), text.size() - unsigned_text.size() + length);
  char* end = nullptr;
  const double found = strtod_l(number.c_str(), &end, c_locale);
  if (length == 0 || end == number.c_str()) return {text.data(), std::errc::invalid_argument};
  const char* const stop = text.data() + (end - number.c_str());
  if (!is_word && (found == 0 || std::isinf(found)) && has_digits(number))
    return {stop, std::errc::result_out_of_range};
  value = found;
  return {stop, std::errc()};
}

#endif

}  // namespace eses::detail
