// Compares numbers that become text a batch at a time with printf.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "test_number_batches.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "output/number_text.hpp"
#include "support/atom_sets.hpp"
#include "support/instruction_sets.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
void make_digits(NumberBatch& batch);
}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail::test {
namespace {

using MakeDigits = void (*)(NumberBatch&);

std::string printf_text(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.12e", value);
  return text.data();
}

// Returns the numbers that the batch leaves to write_scientific().
std::size_t require_same_texts(MakeDigits make, std::span<const double> values) {
  NumberBatch batch;
  // Text of an earlier batch must not matter.
  batch.scaled.fill(1.5e12);
  batch.needs_exact = ~std::uint64_t{0};
  for (const double value : values) batch.add(value);
  make(batch);
  std::size_t uncertain = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::array<char, max_number_length> text{};
    const std::string ours(text.data(), write_number(text.data(), batch, i));
    if (ours != printf_text(values[i])) REQUIRE(ours == printf_text(values[i]));
    uncertain += batch.needs_exact >> i & 1;
  }
  return uncertain;
}

std::size_t require_same_texts_in_batches(MakeDigits make, const std::vector<double>& values,
                                          std::size_t batch_size) {
  std::size_t uncertain = 0;
  for (std::size_t i = 0; i < values.size(); i += batch_size)
    uncertain += require_same_texts(
        make, std::span(values).subspan(i, std::min(batch_size, values.size() - i)));
  return uncertain;
}

std::vector<double> random_numbers(std::size_t count, int min_exponent, int max_exponent) {
  Random random(21);
  std::vector<double> values;
  while (values.size() < count) {
    const double exponent = random.uniform(min_exponent, max_exponent);
    values.push_back(random.uniform(-1, 1) * std::pow(10, exponent));
  }
  return values;
}

// Doubles nearest to powers of ten, and their neighbours.
std::vector<double> powers_of_ten() {
  std::vector<double> values;
  for (int exponent = -25; exponent <= 25; ++exponent) {
    double below = std::stod("1e" + std::to_string(exponent)), above = below;
    for (int i = 0; i < 40; ++i) {
      values.insert(values.end(), {below, -below, above, -above});
      below = std::nextafter(below, 0);
      above = std::nextafter(above, 1e300);
    }
    // The last digits round up, and may carry into the power of ten.
    for (const double nines : {9.9999999999994, 9.9999999999995, 9.9999999999996, 9.99999999999949})
      values.push_back(nines * std::pow(10, exponent));
  }
  return values;
}

// Halves of the last digit that are exact in binary, and their neighbours.
std::vector<double> ties() {
  Random random(22);
  std::vector<double> values;
  for (int power = 0; power <= 8; ++power) {
    // (n + 1/2) 10^(power - 12) is exact if 2n + 1 has all factors of five. It is then an odd
    // multiple of the power of five.
    const double unit = std::ldexp(1, power - 13);
    const double low = std::pow(10, power) / unit;
    for (int i = 0; i < 400; ++i) {
      const double odd = 2 * std::floor(random.uniform(low, 10 * low) / 2) + 1;
      const double tie = odd * unit;
      if (tie >= std::pow(10, power + 1)) continue;
      values.insert(values.end(), {tie, -tie, std::nextafter(tie, 0), std::nextafter(tie, 1e300)});
    }
  }
  return values;
}

std::vector<double> special_numbers() {
  using Limits = std::numeric_limits<double>;
  std::vector<double> values{0.0,
                             1.0,
                             Limits::min(),
                             Limits::max(),
                             Limits::denorm_min(),
                             1234 * Limits::denorm_min(),
                             std::nextafter(Limits::min(), 0),
                             Limits::infinity(),
                             Limits::quiet_NaN(),
                             Limits::epsilon(),
                             4503599627370496.0,
                             9007199254740993.0};
  const std::size_t count = values.size();
  for (std::size_t i = 0; i < count; ++i) values.push_back(-values[i]);
  return values;
}

const Versions<MakeDigits> versions = ESES_VERSIONS(make_digits);

}  // namespace

TEST_CASE("batches of numbers have the digits of printf's %.12e") {
  for_each_version(versions, [](MakeDigits make) {
    require_same_texts_in_batches(make, random_numbers(100000, -14, 14), 64);
    require_same_texts_in_batches(make, random_numbers(20000, -320, 309), 64);
    require_same_texts_in_batches(make, powers_of_ten(), 64);
    require_same_texts_in_batches(make, ties(), 64);
    std::vector<double> coordinates;
    for (int i = -50000; i < 50000; ++i)
      coordinates.insert(coordinates.end(), {i * 0.001, i * 0.4 - 5.251});
    require_same_texts_in_batches(make, coordinates, 64);
  });
}

TEST_CASE("a batch of any size has the texts of any numbers") {
  const std::vector<double> special = special_numbers();
  for_each_version(versions, [&](MakeDigits make) {
    Random random(23);
    for (std::size_t size = 0; size <= NumberBatch::capacity; ++size)
      for (int repetition = 0; repetition < 10; ++repetition) {
        std::vector<double> values = random_numbers(size, -12, 12);
        for (double& value : values)
          if (random.chance(0.2)) value = special[random.integer(0, special.size() - 1)];
        require_same_texts(make, values);
      }
  });
}

TEST_CASE("few numbers of the usual size need the slow way") {
  const std::vector<double> values = random_numbers(100000, -6, 3);
  for_each_version(versions, [&](MakeDigits make) {
    // 0.3 % of the numbers are nearer to a tie than 0.0015. A build without vectors does all in the
    // slow way.
    const std::size_t uncertain = require_same_texts_in_batches(make, values, 64);
    CHECK((uncertain < values.size() / 100 || HWY_TARGET == HWY_SCALAR));
  });
}

}  // namespace eses::detail::test
#endif  // HWY_ONCE
