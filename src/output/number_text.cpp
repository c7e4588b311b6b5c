#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "output/number_text.cpp"
#include "output/number_text.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "grid/point_bits.hpp"
#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"

// Constants of the scalar and the vector code, defined once for all instruction sets.
#ifndef ESES_IO_NUMBER_TEXT_SHARED_
#define ESES_IO_NUMBER_TEXT_SHARED_
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
constexpr double near_tie = 0.0015;

constexpr std::uint64_t leading_unit = 1000000000000;  // smallest number with 13 digits
constexpr std::uint64_t trailing_unit = 100000000;     // separates the last eight digits

}  // namespace
}  // namespace eses::detail
#endif  // ESES_IO_NUMBER_TEXT_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

// Without vectors, write_scientific() is as fast.
void make_digits(NumberBatch& batch) { batch.needs_exact = ~std::uint64_t{0}; }

#else

// The vector version of eight_digits() below.
HWY_INLINE WordVector eight_digits(WordVector value) {
  const Words words;
  const hn::Repartition<std::uint32_t, Doubles> halves;
  const hn::Repartition<std::uint16_t, Doubles> quarters;
  const auto multiply = [&](WordVector low_halves, std::uint32_t factor) {
    return hn::MulEven(hn::BitCast(halves, low_halves), hn::Set(halves, factor));
  };
  // 109951163 / 2^40 exceeds 1e-4 so little that all quotients of numbers below 10^8 are exact: T.
  // Granlund and P. L. Montgomery, Proc. PLDI '94, 61, 1994, doi:10.1145/178243.178249.
  const auto ten_thousands = hn::ShiftRight<40>(multiply(value, 109951163));
  const auto fours = hn::BitCast(
      halves, ten_thousands | hn::ShiftLeft<32>(value - multiply(ten_thousands, 10000)));
  const auto hundreds = hn::ShiftRight<20>(fours * hn::Set(halves, 10486));
  const auto pairs =
      hn::BitCast(quarters, hundreds | hn::ShiftLeft<16>(fours - hundreds * hn::Set(halves, 100)));
  const auto tens = hn::ShiftRight<10>(pairs * hn::Set(quarters, 103));
  const auto digits = tens | hn::ShiftLeft<8>(pairs - tens * hn::Set(quarters, 10));
  return hn::BitCast(words, digits) | hn::Set(words, 0x3030303030303030);
}

void make_digits(NumberBatch& batch) {
  const Doubles doubles;
  const Words words;
  const std::size_t lanes = hn::Lanes(doubles);
  const auto half = broadcast(0.5), one = broadcast(1);
  const auto unit = broadcast(static_cast<double>(leading_unit));
  const auto hundred_millions = broadcast(static_cast<double>(trailing_unit));
  batch.needs_exact = 0;
  for (std::size_t i = 0; i < batch.count; i += lanes) {
    const auto scaled = load(batch.scaled.data() + i);
    const auto whole = hn::Floor(scaled);
    const auto fraction = scaled - whole;
    const auto digits = whole + hn::IfThenElseZero(fraction > half, one);
    const auto is_plain = hn::And(hn::Abs(fraction - half) >= broadcast(near_tie),
                                  hn::And(digits >= unit, digits < broadcast(10) * unit));
    batch.needs_exact |=
        (~std::uint64_t{mask_bits(Doubles(), is_plain)} & low_bits(static_cast<int>(lanes))) << i;

    // The quotient may be off by one. The remainder shows it.
    auto high = hn::Floor(digits * broadcast(1.0 / static_cast<double>(trailing_unit)));
    const auto rest = digits - high * hundred_millions;
    high = high - hn::IfThenElseZero(rest < hn::Zero(doubles), one) +
           hn::IfThenElseZero(rest >= hundred_millions, one);
    const auto low = digits - high * hundred_millions;
    const auto five = hn::ShiftRight<24>(eight_digits(to_words(high)));
    const auto first = five & hn::Set(words, 0xff);
    const auto point = hn::Set(words, std::uint64_t{'.'} << 8);
    hn::StoreU(first | point | hn::ShiftLeft<16>(hn::ShiftRight<8>(five)), words,
               batch.leading.data() + i);
    hn::StoreU(eight_digits(to_words(low)), words, batch.trailing.data() + i);
  }
}

#endif

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// Returns the eight decimal digits of `value` < 10^8, the first in the lowest byte. Splits the
// number into halves three times: into groups of four digits in 32-bit lanes, pairs in 16-bit
// lanes, and digits in bytes. Multiplications by 10486 / 2^20 and 103 / 2^10 divide by 100 and 10.
// They are exact for all values below 10^4 and 10^2.
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

// Returns the exponent of the largest power of ten that does not exceed `magnitude`, in [1e-10,
// 1e10). It may be off by one if rounding in the multiplication carries to another number of
// digits; callers check the digits.
int decimal_exponent(double magnitude) {
  const int binary = static_cast<int>(std::bit_cast<std::uint64_t>(magnitude) >> 52) - 1023;
  // floor(binary * log10(2)): the exponent, or one below it.
  const int guess = (binary * 1233) >> 12;
  const int next = guess + 1;
  return next - min_exponent < static_cast<int>(powers_from_min.size()) &&
                 magnitude >= powers_from_min[static_cast<std::size_t>(next - min_exponent)]
             ? next
             : guess;
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
  if (magnitude == 0) {
    if (std::signbit(value)) *out++ = '-';
    std::memcpy(out, "0.000000000000e+00", 18);
    return out + 18;
  }
  if (!(magnitude >= min_fast_magnitude && magnitude < fast_magnitude_end))
    return write_exactly(out, value);
  int exponent = decimal_exponent(magnitude);
  const int power = digits_after_point - exponent;
  const double scaled = magnitude * exact_powers[static_cast<std::size_t>(power)];
  auto digits = static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled));
  const double fraction = scaled - static_cast<double>(static_cast<std::int64_t>(digits));
  if (std::fabs(fraction - 0.5) < near_tie) return write_exactly(out, value);
  digits += fraction > 0.5;
  if (digits >= 10 * leading_unit) {
    digits = leading_unit;
    ++exponent;
  }
  if (digits < leading_unit) return write_exactly(out, value);
  if (value < 0) *out++ = '-';
  // The five digits are stored one byte to the right. The point then overwrites the byte of the
  // first digit, which moves to the left.
  const std::uint64_t leading = eight_digits(digits / trailing_unit) >> 24;
  store_text(out + 1, leading);
  out[0] = static_cast<char>(leading & 0xff);
  out[1] = '.';
  store_text(out + 6, eight_digits(digits % trailing_unit));
  std::memcpy(out + 14, power_texts[static_cast<std::size_t>(exponent - min_exponent)].data(), 4);
  return out + 18;
}

void NumberBatch::add(double value) {
  const double magnitude = std::fabs(value);
  values[count] = value;
  scaled[count] = 0;  // never valid, so the number needs write_scientific()
  if (magnitude >= min_fast_magnitude && magnitude < fast_magnitude_end) {
    const int exponent = decimal_exponent(magnitude);
    scaled[count] =
        magnitude * exact_powers[static_cast<std::size_t>(digits_after_point - exponent)];
    power[count] = power_texts[static_cast<std::size_t>(exponent - min_exponent)];
  }
  ++count;
}

void make_digits(NumberBatch& batch) { ESES_BEST_VERSION(make_digits)(batch); }

char* write_number(char* out, const NumberBatch& batch, std::size_t i) {
  if (batch.needs_exact >> i & 1) return write_scientific(out, batch.values[i]);
  // Branch-free: half of all components of normals are negative.
  *out = '-';
  out += static_cast<std::size_t>(std::signbit(batch.values[i]));
  store_text(out, batch.leading[i]);
  store_text(out + 6, batch.trailing[i]);
  std::memcpy(out + 14, batch.power[i].data(), 4);
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
#endif  // HWY_ONCE
