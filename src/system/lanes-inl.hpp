/// Vectors of doubles, of 64-bit words and of floats, of the width of the instruction set. Highway
/// includes this file once for each instruction set.

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "system/selection_tables.hpp"

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
using Floats = hn::ScalableTag<float>;
using FloatVector = hn::Vec<Floats>;
using FloatMask = hn::Mask<Floats>;

/// Return a vector with this value in all lanes.
HWY_INLINE DoubleVector broadcast(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE FloatVector broadcast_float(double value) {
  return hn::Set(Floats(), static_cast<float>(value));
}

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

/// Returns the lanes of a mask for which `predicate(lane)` holds, which is called in ascending
/// order.
template <class Predicate>
HWY_INLINE DoubleMask lanes_where(DoubleMask mask, Predicate&& predicate) {
  std::array<std::uint8_t, 8> bytes{};  // no more than 8 lanes are set
  static_assert(HWY_MAX_BYTES / sizeof(double) <= 8);
  for_each_lane(mask, [&](std::size_t lane) {
    bytes[0] |= static_cast<std::uint8_t>(predicate(lane) ? 1U << lane : 0U);
  });
  return hn::LoadMaskBits(Doubles(), bytes.data());
}

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || \
    (HWY_ARCH_ARM_A64 && HWY_TARGET != HWY_SCALAR)
// Stores the elements of a block of eight that are set in `bits` one after another, and returns
// their number. Writes the whole block.
template <class Block>
HWY_INLINE std::size_t compress_block(Block block, hn::Vec<Block> values, std::uint32_t bits,
                                      std::int16_t* to) {
  const auto bytes = hn::LoadU(hn::Full128<std::uint8_t>(), selected_bytes[bits].data());
  hn::StoreU(hn::TableLookupBytes(values, hn::BitCast(block, bytes)), block, to);
  return static_cast<std::size_t>(std::popcount(bits));
}
#endif

/// Stores the lanes of `values` that are set in the mask one after another, and returns their
/// number. There must be room for a whole vector. Highway's function is used with AVX-512 only:
/// with other instruction sets it looks up a permutation in a table, which g++ copies to the stack
/// in each call.
template <class Lanes>
HWY_INLINE std::size_t compress_store(Lanes lanes, hn::Vec<Lanes> values, hn::Mask<Lanes> mask,
                                      hn::TFromD<Lanes>* to) {
#if HWY_TARGET <= HWY_AVX3
  return hn::CompressStore(values, mask, lanes, to);
#else
  using Value = hn::TFromD<Lanes>;
#if HWY_TARGET == HWY_AVX2
  if constexpr (sizeof(Value) == 8) {
    const hn::Repartition<std::uint32_t, Lanes> words;
    const std::uint32_t bits = mask_bits(lanes, mask);
    const auto order = hn::IndicesFromVec(words, hn::LoadU(words, selected_words[bits].data()));
    const auto selected = hn::TableLookupLanes(hn::BitCast(words, values), order);
    hn::StoreU(hn::BitCast(lanes, selected), lanes, to);
    return static_cast<std::size_t>(std::popcount(bits));
  }
  if constexpr (sizeof(Value) == 4 && hn::MaxLanes(Lanes()) == 8) {
    const hn::Repartition<std::uint32_t, Lanes> words;
    const hn::Rebind<std::uint8_t, Lanes> bytes;
    const std::uint32_t bits = mask_bits(lanes, mask);
    const auto order = hn::PromoteTo(words, hn::LoadU(bytes, selected_lanes[bits].data()));
    const auto selected =
        hn::TableLookupLanes(hn::BitCast(words, values), hn::IndicesFromVec(words, order));
    hn::StoreU(hn::BitCast(lanes, selected), lanes, to);
    return static_cast<std::size_t>(std::popcount(bits));
  }
  if constexpr (sizeof(Value) == 2) {
    const hn::Half<Lanes> block;
    const std::uint32_t bits = mask_bits(lanes, mask);
    const std::size_t count = compress_block(block, hn::LowerHalf(block, values), bits & 0xff, to);
    return count + compress_block(block, hn::UpperHalf(block, values), bits >> 8, to + count);
  }
#elif HWY_TARGET == HWY_SSE4 || (HWY_ARCH_ARM_A64 && HWY_TARGET != HWY_SCALAR)
  if constexpr (sizeof(Value) == 4) {
    const hn::Repartition<std::uint8_t, Lanes> bytes;
    const std::uint32_t bits = mask_bits(lanes, mask);
    const auto order = hn::LoadU(bytes, selected_bytes_of_words[bits].data());
    hn::StoreU(hn::BitCast(lanes, hn::TableLookupBytes(hn::BitCast(bytes, values), order)), lanes,
               to);
    return static_cast<std::size_t>(std::popcount(bits));
  }
  if constexpr (sizeof(Value) == 2)
    return compress_block(lanes, values, mask_bits(lanes, mask), to);
#endif
  std::array<Value, HWY_MAX_BYTES / sizeof(Value)> all;
  hn::StoreU(values, lanes, all.data());
  std::size_t count = 0;
  for_each_lane(lanes, mask, [&](std::size_t lane) { to[count++] = all[lane]; });
  return count;
#endif
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
