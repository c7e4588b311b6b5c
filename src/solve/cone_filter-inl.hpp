/// Which directions lie in none of a face's cones, several at a time. Included anew for every
/// instruction set, see Highway.

#include <span>

#include "simd/points-inl.hpp"
#include "solve/block_features.hpp"

#if defined(ESES_SOLVE_CONE_FILTER_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_CONE_FILTER_INL_
#undef ESES_SOLVE_CONE_FILTER_INL_
#else
#define ESES_SOLVE_CONE_FILTER_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Begins with the cone that held the last ones: neighbouring points tend to fall to the same. What
/// is left does not depend on the order.
class ConeFilter {
 public:
  HWY_INLINE explicit ConeFilter(std::span<const CapCone> cones) : cones_(cones) {}

  /// The lanes of `candidates` that lie in none of the cones, whose rims `limit(cone)` gives as the
  /// largest `axis . direction`.
  template <class Limit>
  HWY_INLINE DoubleMask outside(DoubleMask candidates, const Points& direction, Limit&& limit) {
    auto left = candidates;
    const auto leave = [&](const CapCone& cone) {
      left = hn::And(left, dot(cone.axis, direction) <= limit(cone));
      return !hn::AllFalse(Doubles(), left);
    };
    if (last_ < cones_.size() && !leave(cones_[last_])) return left;
    for (std::size_t k = 0; k < cones_.size(); ++k)
      if (!leave(cones_[k])) {
        last_ = k;
        break;
      }
    return left;
  }

 private:
  std::span<const CapCone> cones_;
  std::size_t last_ = 0;
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
