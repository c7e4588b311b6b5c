/// Points in space, one in each lane. Included anew for every instruction set, see Highway.

#include <hwy/highway.h>

#include <cstddef>

#include "eses/vec3.hpp"

#if defined(ESES_SIMD_POINTS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SIMD_POINTS_INL_
#undef ESES_SIMD_POINTS_INL_
#else
#define ESES_SIMD_POINTS_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Words = hn::Repartition<std::uint64_t, Doubles>;
using DoubleVector = hn::Vec<Doubles>;
using WordVector = hn::Vec<Words>;
using DoubleMask = hn::Mask<Doubles>;

HWY_INLINE DoubleVector all(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE DoubleVector load(const double* from) { return hn::LoadU(Doubles(), from); }

struct Points {
  DoubleVector x, y, z;
};

template <std::size_t axis>
HWY_INLINE DoubleVector& along(Points& points) {
  return axis == 0 ? points.x : axis == 1 ? points.y : points.z;
}

HWY_INLINE DoubleVector dot(Vec3 a, const Points& b) {
  return all(a.x) * b.x + all(a.y) * b.y + all(a.z) * b.z;
}

HWY_INLINE DoubleVector squared_norm(const Points& a) {
  return a.x * a.x + a.y * a.y + a.z * a.z;
}

/// Calls `action(lane)` for every lane of the mask.
template <class Action>
HWY_INLINE void for_each_lane(DoubleMask mask, Action&& action) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Doubles(), mask, bytes);
  for (unsigned bits = bytes[0]; bits != 0; bits &= bits - 1)
    action(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace eses::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
