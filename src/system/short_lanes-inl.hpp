/// Vectors of 16-bit integers, of the width of the instruction set. Highway includes this file once
/// for each instruction set.
///
/// `sn` has functions with the names and meanings of Highway's functions. It is Highway's
/// namespace, except for the baseline of x86-64: Highway has one lane there, but all processors
/// have SSE2, whose vectors have eight lanes.

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "system/lanes-inl.hpp"

#if HWY_TARGET == HWY_SCALAR && defined(__SSE2__)
#include <emmintrin.h>
#endif

#if defined(ESES_SIMD_SHORT_LANES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SIMD_SHORT_LANES_INL_
#undef ESES_SIMD_SHORT_LANES_INL_
#else
#define ESES_SIMD_SHORT_LANES_INL_
#endif

#if HWY_TARGET == HWY_SCALAR && defined(__SSE2__)
HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

namespace sn {

struct ShortLanes {};
using ShortVector = __m128i;
using ShortMask = __m128i;  // all bits of a lane are equal

inline std::size_t Lanes(ShortLanes) { return sizeof(__m128i) / sizeof(std::int16_t); }

inline ShortVector LoadU(ShortLanes, const std::int16_t* from) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}
inline void StoreU(ShortVector values, ShortLanes, std::int16_t* to) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to), values);
}
inline ShortVector Set(ShortLanes, std::int16_t value) { return _mm_set1_epi16(value); }
inline ShortVector Add(ShortVector a, ShortVector b) { return _mm_add_epi16(a, b); }
inline ShortVector MulHigh(ShortVector a, ShortVector b) { return _mm_mulhi_epi16(a, b); }
inline ShortMask Gt(ShortVector a, ShortVector b) { return _mm_cmpgt_epi16(a, b); }
inline ShortMask And(ShortMask a, ShortMask b) { return _mm_and_si128(a, b); }
inline ShortMask AndNot(ShortMask excluded, ShortMask a) { return _mm_andnot_si128(excluded, a); }
inline bool AllFalse(ShortLanes, ShortMask mask) { return _mm_movemask_epi8(mask) == 0; }
inline ShortMask FirstN(ShortLanes, std::size_t count) {
  const auto end = static_cast<std::int16_t>(count < 8 ? count : 8);
  return _mm_cmpgt_epi16(_mm_set1_epi16(end), _mm_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7));
}

}  // namespace sn

using sn::ShortLanes;
using sn::ShortMask;
using sn::ShortVector;

/// The version of compress_store() for these vectors.
inline std::size_t compress_store(ShortLanes lanes, ShortVector values, ShortMask mask,
                                  std::int16_t* to) {
  std::array<std::int16_t, 8> all;
  sn::StoreU(values, lanes, all.data());
  std::size_t count = 0;
  const ShortVector bytes = _mm_packs_epi16(mask, _mm_setzero_si128());
  for (auto bits = static_cast<unsigned>(_mm_movemask_epi8(bytes)); bits != 0; bits &= bits - 1)
    to[count++] = all[static_cast<std::size_t>(std::countr_zero(bits))];
  return count;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#else
namespace eses::detail::HWY_NAMESPACE {

namespace sn = hwy::HWY_NAMESPACE;
using ShortLanes = sn::ScalableTag<std::int16_t>;
using ShortVector = sn::Vec<ShortLanes>;
using ShortMask = sn::Mask<ShortLanes>;

}  // namespace eses::detail::HWY_NAMESPACE
#endif

#endif
