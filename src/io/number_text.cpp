#include "io/number_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace eses {
namespace {

constexpr int digits_after_point = 12;

// Eight decimal digits of `value` < 10^8, the first in the lowest byte. The number is split in
// halves three times, in all parts at once: fours of digits in 32-bit lanes, pairs in 16, digits
// in 8. The multiplications are divisions by 100 and 10, exact for what a lane can hold.
std::uint64_t eight_digits(std::uint64_t value) {
  const std::uint64_t fours = value / 10000 | value % 10000 << 32;
  const std::uint64_t hundreds = (fours * 10486 >> 20) & 0x0000007f0000007f;
  const std::uint64_t pairs = hundreds | (fours - 100 * hundreds) << 16;
  const std::uint64_t tens = (pairs * 103 >> 10) & 0x000f000f000f000f;
  const std::uint64_t digits = tens | (pairs - 10 * tens) << 8;
  return digits + 0x3030303030303030;
}

void store_text(char* out, std::uint64_t bytes) {
  if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
  std::memcpy(out, &bytes, sizeof bytes);
}

// 10^0 to 10^22 are exact in double precision.
constexpr int largest_exact_power = 22;
constexpr std::array<double, largest_exact_power + 1> exact_powers{
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int least_exponent = digits_after_point - largest_exact_power;

constexpr std::array<double, 21> powers_from_least{1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4,
                                                   1e-3,  1e-2, 1e-1, 1e0,  1e1,  1e2,  1e3,
                                                   1e4,   1e5,  1e6,  1e7,  1e8,  1e9,  1e10};

// The power of ten at or below `magnitude`, which lies in [1e-10, 1e10), or one off where the
// magnitude is within rounding of a power; the digits tell.
int decimal_exponent(double magnitude) {
  const int binary = static_cast<int>(std::bit_cast<std::uint64_t>(magnitude) >> 52) - 1023;
  // floor(binary log10(2)), which is the exponent or one below it.
  const int guess = (binary * 1233) >> 12;
  const int next = guess + 1;
  return next - least_exponent < static_cast<int>(powers_from_least.size()) &&
                 magnitude >= powers_from_least[static_cast<std::size_t>(next - least_exponent)]
             ? next
             : guess;
}

char* write_exactly(char* out, double value) {
  if (std::isfinite(value))
    return std::to_chars(out, out + longest_number_text, value, std::chars_format::scientific,
                         digits_after_point)
        .ptr;
  return out + std::snprintf(out, longest_number_text, "%.12e", value);
}

}  // namespace

char* write_scientific(char* out, double value) {
  const double magnitude = std::fabs(value);
  if (magnitude == 0) {
    if (std::signbit(value)) *out++ = '-';
    std::memcpy(out, "0.000000000000e+00", 18);
    return out + 18;
  }
  if (!(magnitude >= 1e-9 && magnitude < 1e9)) return write_exactly(out, value);
  int exponent = decimal_exponent(magnitude);
  const int power = digits_after_point - exponent;
  const double scaled = magnitude * exact_powers[static_cast<std::size_t>(power)];
  auto digits = static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled));
  const double fraction = scaled - static_cast<double>(static_cast<std::int64_t>(digits));
  // One rounding of a number below 1e13 errs by less than 0.001: only near a tie could it matter.
  if (std::fabs(fraction - 0.5) < 0.0015) return write_exactly(out, value);
  digits += fraction > 0.5;
  constexpr std::uint64_t leading_unit = 1000000000000;
  if (digits >= 10 * leading_unit) {
    digits = leading_unit;
    ++exponent;
  }
  if (digits < leading_unit) return write_exactly(out, value);
  if (value < 0) *out++ = '-';
  // Five digits, one place to the right: the point then takes the place of the first.
  constexpr std::uint64_t eight = 100000000;
  const std::uint64_t leading = eight_digits(digits / eight) >> 24;
  store_text(out + 1, leading);
  out[0] = static_cast<char>(leading & 0xff);
  out[1] = '.';
  store_text(out + 6, eight_digits(digits % eight));
  out[14] = 'e';
  out[15] = exponent < 0 ? '-' : '+';
  out[16] = '0';  // below 1e9 and above 1e-10 one digit is enough
  out[17] = static_cast<char>('0' + std::abs(exponent));
  return out + 18;
}

char* write_index(char* out, std::uint64_t value) {
  if (value < 100000000) {
    // The leading zeros are shifted out.
    const std::uint64_t digits = eight_digits(value);
    const int zeros = std::min(std::countr_zero(digits & 0x0f0f0f0f0f0f0f0f) / 8, 7);
    store_text(out, digits >> (8 * zeros));
    return out + 8 - zeros;
  }
  return std::to_chars(out, out + longest_number_text, value).ptr;
}

}  // namespace eses
