/// Fuzzes the conversion of numbers from and to text, with the C library as the reference. The
/// input is used both as the text of a number and as the bytes of numbers to print.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include "expect.hpp"
#include "input/text_fields.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail::fuzz {
namespace {

// ----------------------------------------------------------------------------------------- read

/// Whether strtod reads the text in the same way, except for Fortran's exponents. This excludes
/// hexadecimal numbers and leading blanks.
bool is_decimal(std::string_view text) {
  return text.find_first_not_of("0123456789+-.eEdD") == std::string_view::npos;
}

/// Converts the text with strtod and returns the error code that parse_number should return.
std::errc read_by_c(std::string_view text, double& value) {
  std::string with_e(text);
  for (char& c : with_e)
    if (c == 'd' || c == 'D') c = 'e';
  char* end = nullptr;
  errno = 0;
  value = std::strtod(with_e.c_str(), &end);
  if (text.empty() || end != with_e.c_str() + with_e.size()) return std::errc::invalid_argument;
  // C may report subnormal numbers as out of range, but returns their value.
  const bool is_lost = errno == ERANGE && (value == 0 || std::isinf(value));
  return is_lost ? std::errc::result_out_of_range : std::errc{};
}

void check_reading(std::string_view text) {
  double value = 0, expected = 0;
  const std::errc error = parse_number(text, value);
  if (!is_decimal(text)) {
    expect(error != std::errc{} || !std::isfinite(value), "a number with other characters");
    return;
  }
  expect(error == read_by_c(text, expected), "a number is read or refused where C does not");
  if (error != std::errc{}) return;
  if (value == expected && std::signbit(value) == std::signbit(expected)) return;
  fail(fmt::format("{} is read as {}, not as {}", text, value, expected));
}

// ---------------------------------------------------------------------------------------- print

void expect_printed(double value, std::string_view text) {
  std::array<char, 64> expected{};
  const int length = std::snprintf(expected.data(), expected.size(), "%.12e", value);
  if (text == std::string_view(expected.data(), static_cast<std::size_t>(length))) return;
  fail(fmt::format("{} is printed as {}, not as {}", value, text, expected.data()));
}

void check_printing(std::string_view bytes) {
  std::array<char, max_number_length> text{};
  for (; bytes.size() >= sizeof(double); bytes.remove_prefix(sizeof(double))) {
    double value = 0;
    std::memcpy(&value, bytes.data(), sizeof(double));
    if (!std::isfinite(value)) continue;
    const char* const end = write_scientific(text.data(), value);
    expect_printed(value, {text.data(), static_cast<std::size_t>(end - text.data())});
  }
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = eses::detail::fuzz::as_text(data, size);
  eses::detail::fuzz::check_reading(bytes);
  eses::detail::fuzz::check_printing(bytes);
  return 0;
}
