/// Tests of several directions against the cones of a face. Highway includes this file once for
/// each instruction set.

#include <span>

#include "solve/block_features.hpp"
#include "system/points-inl.hpp"

#if defined(ESES_SOLVE_CONE_FILTER_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_CONE_FILTER_INL_
#undef ESES_SOLVE_CONE_FILTER_INL_
#else
#define ESES_SOLVE_CONE_FILTER_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Selects directions that lie in none of the cones. It starts with the cone that excluded the
/// previous directions, as neighbouring points are often in the same cone. The result does not
/// depend on the order of the cones.
class ConeFilter {
 public:
  HWY_INLINE explicit ConeFilter(std::span<const CapCone> cones) : cones_(cones) {}

  /// Returns the lanes of `candidates` whose directions lie in none of the cones: those with
  /// `axis . direction <= limit(cone)` for each cone.
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
