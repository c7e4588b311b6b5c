/// Vectors of doubles and of 64-bit words, of the width of the instruction set. Highway includes
/// this file once for each instruction set.

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if defined(ESES_SIMD_LANES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SIMD_LANES_INL_
#undef ESES_SIMD_LANES_INL_
#else
#define ESES_SIMD_LANES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Words = hn::Repartition<std::uint64_t, Doubles>;
using DoubleVector = hn::Vec<Doubles>;
using WordVector = hn::Vec<Words>;
using DoubleMask = hn::Mask<Doubles>;

/// Returns a vector with this value in all lanes.
HWY_INLINE DoubleVector broadcast(double value) { return hn::Set(Doubles(), value); }

/// Loads a vector from memory that need not be aligned.
HWY_INLINE DoubleVector load(const double* from) { return hn::LoadU(Doubles(), from); }

/// Converts whole numbers from 0 to 2^52 - 1 from double to integer. Adding 2^52 moves the number
/// into the low bits of the mantissa.
HWY_INLINE WordVector to_words(DoubleVector whole) {
  const auto two_to_52 = broadcast(4503599627370496.0);
  return hn::Xor(hn::BitCast(Words(), whole + two_to_52), hn::BitCast(Words(), two_to_52));
}

/// Returns the mask of up to 32 lanes as bits; lane 0 is the lowest bit.
template <class Lanes>
HWY_INLINE std::uint32_t mask_bits(Lanes lanes, hn::Mask<Lanes> mask) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(lanes, mask, bytes.data());
  std::uint32_t bits = bytes[0];
  for (unsigned byte = 1; byte < 4; ++byte) bits |= std::uint32_t{bytes[byte]} << (8 * byte);
  return bits;
}

/// The values of a vector's lanes, for access by index.
struct LaneValues {
  std::array<double, HWY_MAX_BYTES / sizeof(double)> values;

  HWY_INLINE explicit LaneValues(DoubleVector vector) {
    hn::StoreU(vector, Doubles(), values.data());
  }
  double operator[](std::size_t lane) const { return values[lane]; }
};

/// Calls `action(lane)` for every lane that is set in the mask, in ascending order.
template <class Lanes, class Action>
HWY_INLINE void for_each_lane(Lanes lanes, hn::Mask<Lanes> mask, Action&& action) {
  for (std::uint32_t bits = mask_bits(lanes, mask); bits != 0; bits &= bits - 1)
    action(static_cast<std::size_t>(std::countr_zero(bits)));
}
template <class Action>
HWY_INLINE void for_each_lane(DoubleMask mask, Action&& action) {
  for_each_lane(Doubles(), mask, action);
}

/// Stores the lanes of `values` that are set in the mask one after another, and returns their
/// number. There must be room for a whole vector. Highway's function is used only where it is an
/// instruction: elsewhere it looks up a permutation in a table, which g++ copies to the stack in
/// each call.
template <class Lanes>
HWY_INLINE std::size_t compress_store(Lanes lanes, hn::Vec<Lanes> values, hn::Mask<Lanes> mask,
                                      hn::TFromD<Lanes>* to) {
#if HWY_TARGET <= HWY_AVX3
  return hn::CompressStore(values, mask, lanes, to);
#else
  std::array<hn::TFromD<Lanes>, HWY_MAX_BYTES / sizeof(hn::TFromD<Lanes>)> all;
  hn::StoreU(values, lanes, all.data());
  std::size_t count = 0;
  for_each_lane(lanes, mask, [&](std::size_t lane) { to[count++] = all[lane]; });
  return count;
#endif
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
