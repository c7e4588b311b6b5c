#include "output/text_buffer.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace eses::detail {
namespace {

constexpr int digits_after_point = 12;

// 10^0 to 10^22 are exact in double precision.
constexpr int max_exact_power = 22;
constexpr std::array<double, max_exact_power + 1> exact_powers{
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int min_exponent = digits_after_point - max_exact_power;

constexpr std::array<double, 21> powers_from_min{1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4,
                                                 1e-3,  1e-2, 1e-1, 1e0,  1e1,  1e2,  1e3,
                                                 1e4,   1e5,  1e6,  1e7,  1e8,  1e9,  1e10};

// Numbers in [min_fast_magnitude, fast_magnitude_end) take the fast path. Their exponent has one
// digit.
constexpr double min_fast_magnitude = 1e-9, fast_magnitude_end = 1e9;

// Distance from 1/2 within which the fraction of a scaled number does not decide the rounding. The
// error of a product below 1e13 is at most half a unit in the last place, 2^-10 < 0.001.
constexpr double tie_distance = 0.0015;

constexpr std::int64_t leading_unit = 1000000000000;  // smallest number with 13 digits

// Returns the exponent of the largest power of ten that does not exceed `magnitude`, in [1e-10,
// 1e9). It may be off by one if rounding in the multiplication carries to another number of digits;
// callers check the digits.
int decimal_exponent(double magnitude) {
  const int binary = static_cast<int>(std::bit_cast<std::uint64_t>(magnitude) >> 52) - 1023;
  // floor(binary * log10(2)): the exponent, or one below it.
  const int guess = (binary * 1233) >> 12;
  return guess +
         static_cast<int>(magnitude >=
                          powers_from_min[static_cast<std::size_t>(guess + 1 - min_exponent)]);
}

// The text for 1e-10 would be wrong, but is not used: the fast path starts at 1e-9.
constexpr std::array<std::array<char, 4>, 20> power_texts = [] {
  std::array<std::array<char, 4>, 20> texts{};
  for (int i = 0; i < 20; ++i) {
    const int exponent = i + min_exponent;
    texts[static_cast<std::size_t>(i)] = {
        'e', exponent < 0 ? '-' : '+', '0',
        static_cast<char>('0' + (exponent < 0 ? -exponent : exponent) % 10)};
  }
  return texts;
}();

// The numbers below 10^4 with four digits each, and padding.
constexpr std::size_t group_digits = 4, group_end = 10000;
constexpr std::array<char, group_digits*(group_end + 1)> group_texts = [] {
  std::array<char, group_digits*(group_end + 1)> texts{};
  for (std::size_t i = 0; i < group_end; ++i) {
    std::size_t rest = i;
    for (std::size_t digit = group_digits; digit-- > 0; rest /= 10)
      texts[group_digits * i + digit] = static_cast<char>('0' + rest % 10);
  }
  return texts;
}();

// Writes the four digits of a number below 10^4.
void put_group(char* out, std::uint64_t value) {
  std::memcpy(out, group_texts.data() + group_digits * value, group_digits);
}

// Writes a number below 10^4 without its first digits, in four bytes. Returns the end of the text.
char* write_group(char* out, std::uint64_t value, std::size_t omitted_digits) {
  std::memcpy(out, group_texts.data() + group_digits * value + omitted_digits, group_digits);
  return out + group_digits - omitted_digits;
}

std::size_t leading_zeros(std::uint64_t group) {
  return std::size_t{group < 1000} + std::size_t{group < 100} + std::size_t{group < 10};
}

char* write_exactly(char* out, double value) {
  if (std::isfinite(value))
    return std::to_chars(out, out + max_number_length, value, std::chars_format::scientific,
                         digits_after_point)
        .ptr;
  return out + std::snprintf(out, max_number_length, "%.12e", value);
}

}  // namespace

char* write_scientific(char* out, double value) {
  const double magnitude = std::fabs(value);
  if (!(magnitude >= min_fast_magnitude && magnitude < fast_magnitude_end))
    return write_exactly(out, value);
  const int exponent = decimal_exponent(magnitude);
  const double scaled =
      magnitude * exact_powers[static_cast<std::size_t>(digits_after_point - exponent)];
  const auto digits =
      static_cast<std::int64_t>(scaled + 0.5);  // NOLINT(bugprone-incorrect-roundings)
  const bool is_near_tie = std::fabs(scaled - static_cast<double>(digits)) > 0.5 - tie_distance;
  if (is_near_tie || digits < leading_unit || digits >= 10 * leading_unit)
    return write_exactly(out, value);
  // Without a branch: half of all components of normals are negative.
  *out = '-';
  out += static_cast<std::size_t>(std::signbit(value));
  const auto others = static_cast<std::uint64_t>(digits % leading_unit);
  out[0] = static_cast<char>('0' + digits / leading_unit);
  out[1] = '.';
  put_group(out + 2, others / (group_end * group_end));
  put_group(out + 6, others / group_end % group_end);
  put_group(out + 10, others % group_end);
  std::memcpy(out + 14, power_texts[static_cast<std::size_t>(exponent - min_exponent)].data(), 4);
  return out + 18;
}

char* write_index(char* out, std::uint64_t value) {
  if (value < group_end) return write_group(out, value, leading_zeros(value));
  if (value < group_end * group_end) {
    const std::uint64_t first = value / group_end;
    return write_group(write_group(out, first, leading_zeros(first)), value % group_end, 0);
  }
  return std::to_chars(out, out + max_number_length, value).ptr;
}

}  // namespace eses::detail
