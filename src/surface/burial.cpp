#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/burial.cpp"
#include "surface/burial.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"
#include "system/short_lanes-inl.hpp"

#ifndef ESES_SURFACE_BURIAL_SHARED_
#define ESES_SURFACE_BURIAL_SHARED_
namespace eses::detail {
namespace {

// If the height of a cap, relative to the radius, grows by `small_shrinkage`, its angular radius
// changes by at most sqrt(2 small_shrinkage) = 9e-5. For patches of 0.2 radians this changes the
// minimum cosines of patches by at most 2e-5. The slack exceeds this, so that a settled patch lies
// in the cap with certainty. Rounding of scaled cosines is added to it.
constexpr double small_shrinkage = 4e-9;
constexpr double shrinkage_slack = 3e-5;

// Caps are ordered by their minimum cosine of settled patches in steps.
constexpr float steps_per_unit = 32;
constexpr std::size_t size_steps = 66;

// The inverse radius of the sphere, and cosine and sine of the angular radius of every patch.
struct PatchCosines {
  double inverse_radius, cosine, sine;
};

}  // namespace
}  // namespace eses::detail
#endif  // ESES_SURFACE_BURIAL_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Directions of patches, one in each lane.
struct Directions {
  ShortVector x, y, z;

  HWY_INLINE Directions(const DirectionList& list, std::size_t i)
      : x(sn::LoadU(ShortLanes(), &list.x[i])),
        y(sn::LoadU(ShortLanes(), &list.y[i])),
        z(sn::LoadU(ShortLanes(), &list.z[i])) {}
};

// A cap's axis, and the limit of the scaled cosines of patches.
struct AxisAndLimit {
  ShortVector x, y, z, limit;

  HWY_INLINE ShortMask accepts(const Directions& to) const {
    const auto scaled_cosine =
        sn::Add(sn::Add(sn::MulHigh(to.x, x), sn::MulHigh(to.y, y)), sn::MulHigh(to.z, z));
    return sn::Gt(scaled_cosine, limit);
  }
};

// Pointers to the axes of caps and to one of their limits. Vector stores may alias the members of a
// std::vector, so the compiler would load its pointer again for each cap.
struct CapLimits {
  const std::int16_t *x, *y, *z, *limit;

  CapLimits(const BurialCaps& caps, const std::vector<std::int16_t>& limits)
      : x(caps.axes.x.data()), y(caps.axes.y.data()), z(caps.axes.z.data()), limit(limits.data()) {}

  HWY_INLINE AxisAndLimit operator[](std::uint32_t cap) const {
    const ShortLanes lanes;
    return {sn::Set(lanes, x[cap]), sn::Set(lanes, y[cap]), sn::Set(lanes, z[cap]),
            sn::Set(lanes, limit[cap])};
  }
};

// Stores copies of the first component after the first `count`, as many as a vector register holds.
HWY_INLINE void pad(std::vector<std::int16_t>& components, std::size_t count) {
  sn::StoreU(sn::Set(ShortLanes(), components[0]), ShortLanes(), &components[count]);
}

// Copies the first `count` directions whose patch none of the caps in `order` settles, and returns
// their number. Marks the caps that settled a patch. `from` must have room for whole vectors; the
// result is padded with copies of its first direction. Both lists may be the same: elements are
// read before they are overwritten.
std::size_t keep_unsettled(BurialCaps& caps, std::span<const std::uint32_t> order,
                           const DirectionList& from, std::size_t count, DirectionList& to) {
  const ShortLanes lanes;
  const std::size_t width = sn::Lanes(lanes);
  const CapLimits limits(caps, caps.settled);
  std::uint8_t* const is_used = caps.is_used.data();
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < count; begin += width) {
    const Directions directions(from, begin);
    ShortMask left = sn::FirstN(lanes, count - begin);
    for (const std::uint32_t k : order) {
      const auto settled = sn::And(limits[k].accepts(directions), left);
      // Without a branch, which would often be predicted wrongly.
      is_used[k] = static_cast<std::uint8_t>(is_used[k] | (sn::AllFalse(lanes, settled) ? 0 : 1));
      left = sn::AndNot(settled, left);
      if (sn::AllFalse(lanes, left)) break;
    }
    if (sn::AllFalse(lanes, left)) continue;
    const std::size_t n = compress_store(lanes, directions.x, left, &to.x[kept]);
    compress_store(lanes, directions.y, left, &to.y[kept]);
    compress_store(lanes, directions.z, left, &to.z[kept]);
    kept += n;
  }
  if (kept > 0)
    for (auto* components : {&to.x, &to.y, &to.z}) pad(*components, kept);
  return kept;
}

// Returns whether the cap reaches one of the first `count` patches, which are padded.
HWY_INLINE bool reaches_any(const AxisAndLimit& cap, const DirectionList& patches,
                            std::size_t count) {
  const ShortLanes lanes;
  for (std::size_t i = 0; i < count; i += sn::Lanes(lanes))
    if (!sn::AllFalse(lanes, cap.accepts(Directions(patches, i)))) return true;
  return false;
}

// Lists the caps that may reach one of the `count` remaining patches, and the others that settled a
// patch.
void list_kept(BurialScratch& scratch, std::size_t count) {
  const BurialCaps& caps = scratch.caps;
  const CapLimits limits(caps, caps.touched);
  for (const std::uint32_t k : caps.order) {
    if (reaches_any(limits[k], scratch.unsettled, count)) {
      scratch.relevant.push_back(k);
    } else if (caps.is_used[k] != 0) {
      scratch.covering.push_back(k);
    }
  }
}

// Cosine and sine of a cap's angular radius.
struct CosineAndSine {
  DoubleVector cosine, sine;
};

HWY_INLINE CosineAndSine angular_radius(DoubleVector height, double inverse_radius) {
  const auto quotient = height * broadcast(inverse_radius);
  const auto cosine =
      hn::IfThenElse(quotient < broadcast(-1), broadcast(-1),
                     hn::IfThenElse(broadcast(1) < quotient, broadcast(1), quotient));
  return {cosine, hn::Sqrt((broadcast(1) - cosine) * (broadcast(1) + cosine))};
}

using Steps = hn::Rebind<std::int32_t, Doubles>;

// Stores the greatest whole numbers that are not above the values. Numbers that do not fit into 16
// bits become the nearest ones that do.
HWY_INLINE void store_floor(DoubleVector values, std::int16_t* to) {
  const hn::Rebind<std::int16_t, Doubles> shorts;
  constexpr std::int32_t offset = 1 << 16;  // makes all values positive, which are then truncated
  const auto positive = hn::DemoteTo(Steps(), values + broadcast(offset));
  hn::StoreU(hn::DemoteTo(shorts, hn::Sub(positive, hn::Set(Steps(), offset))), shorts, to);
}

HWY_INLINE void store_component(DoubleVector values, std::int16_t* to) {
  store_floor(values * broadcast(direction_scale) + broadcast(0.5), to);
}

// Returns the step of a cap with this minimum cosine of settled patches.
HWY_INLINE hn::Vec<Steps> step_of(DoubleVector settled) {
  const hn::Rebind<float, Doubles> floats;
  const auto one = hn::Set(floats, 1.0F);
  const auto clamped = hn::Min(hn::Max(hn::DemoteTo(floats, settled), hn::Neg(one)), one);
  return hn::ConvertTo(Steps(), hn::Mul(hn::Set(floats, steps_per_unit), hn::Add(clamped, one)));
}

// Computes the axes, the steps and the limits of settled patches. The minimum cosine from the axis
// of patches that lie in a cap is the cosine of the difference of the angular radii of cap and
// patch, plus slack.
void prepare_caps(const CapList& caps, const PatchCosines& patch, BurialCaps& prepared) {
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(Doubles())) {
    const auto height = load(&caps.height[k]), blocking = load(&caps.blocking_height[k]);
    // The slackened cap of a neighbour at almost the same position is nearly empty, so its exact
    // cap must not replace others.
    const auto shrinks =
        (blocking - height) * broadcast(patch.inverse_radius) > broadcast(small_shrinkage);
    const auto [cosine, sine] =
        angular_radius(hn::IfThenElse(shrinks, blocking, height), patch.inverse_radius);
    const auto can_settle = cosine < broadcast(patch.cosine);  // the cap is wider than a patch
    const auto min_cosine =
        hn::IfThenElse(can_settle,
                       cosine * broadcast(patch.cosine) + sine * broadcast(patch.sine) +
                           broadcast(shrinkage_slack),
                       broadcast(2));
    hn::StoreU(step_of(min_cosine), Steps(), &prepared.step[k]);
    store_floor(min_cosine * broadcast(cosine_scale) + broadcast(max_cosine_excess + 1),
                &prepared.settled[k]);
    store_component(load(&caps.x[k]), &prepared.axes.x[k]);
    store_component(load(&caps.y[k]), &prepared.axes.y[k]);
    store_component(load(&caps.z[k]), &prepared.axes.z[k]);
  }
}

// Computes the limits of the patches that caps may reach. The minimum cosine from the axis is the
// cosine of the sum of the angular radii of cap and patch, less slack.
void find_touched(const CapList& caps, const PatchCosines& patch, BurialCaps& prepared) {
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(Doubles())) {
    const auto [cosine, sine] = angular_radius(load(&caps.height[k]), patch.inverse_radius);
    const auto touches_any =
        cosine <= broadcast(-patch.cosine);  // the cap reaches the opposite patch
    const auto min_cosine =
        hn::IfThenElse(touches_any, broadcast(-2),
                       cosine * broadcast(patch.cosine) - sine * broadcast(patch.sine) -
                           broadcast(shrinkage_slack));
    store_floor(min_cosine * broadcast(cosine_scale) - broadcast(max_cosine_deficit),
                &prepared.touched[k]);
  }
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {

namespace {

// Numbers of caps after which the remaining patches are counted. Most buried atoms need no more.
constexpr std::array<std::size_t, 2> caps_per_count{16, 32};

// Lists the caps in ascending order of their steps. Within a step they keep their order.
void order_by_size(std::size_t count, BurialCaps& caps) {
  std::array<std::uint32_t, size_steps> next{};
  const std::span<const std::int32_t> steps = std::span(caps.step).first(count);
  for (const std::int32_t step : steps) ++next[static_cast<std::size_t>(step) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  caps.order.resize(count);
  for (std::uint32_t k = 0; k < count; ++k)
    caps.order[next[static_cast<std::size_t>(steps[k])]++] = k;
}

// Makes room for `count` caps. The values of new elements are unspecified.
void make_room(BurialCaps& caps, std::size_t count) {
  caps.is_used.assign(count, 0);
  if (caps.step.size() >= count + vector_padding) return;
  const std::size_t size = 2 * count + vector_padding;
  for (auto* values : {&caps.axes.x, &caps.axes.y, &caps.axes.z, &caps.settled, &caps.touched})
    values->resize(size);
  caps.step.resize(size);
}

// Frequency of the covering directions, which gives 252 of them. More directions would take more
// time than they save.
constexpr int burial_frequency = 5;

// Frequency without a probe, which gives 92 directions. Then few atoms are buried, and each one has
// few caps.
constexpr int bare_burial_frequency = 3;

std::int16_t to_component(double value) {
  return static_cast<std::int16_t>(std::nearbyint(direction_scale * value));
}

}  // namespace

BurialPatches::BurialPatches(const CoveringDirections& covering)
    : count(covering.directions.size()),
      cosine(std::cos(covering.radius)),
      sine(std::sin(covering.radius)) {
  const std::size_t lanes = sizeof(float) / sizeof(std::int16_t) * vector_padding;
  const std::size_t padded = count + lanes;
  for (auto* values : {&directions.x, &directions.y, &directions.z}) values->resize(padded);
  for (std::size_t k = 0; k < count; ++k) {
    directions.x[k] = to_component(covering.directions[k].x);
    directions.y[k] = to_component(covering.directions[k].y);
    directions.z[k] = to_component(covering.directions[k].z);
  }
}

const BurialPatches& burial_patches(bool has_probe) {
  if (has_probe) {
    static const BurialPatches patches(make_covering_directions(burial_frequency));
    return patches;
  }
  static const BurialPatches bare_patches(make_covering_directions(bare_burial_frequency));
  return bare_patches;
}

bool is_buried(const CapList& caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch) {
  const auto keep = ESES_BEST_VERSION(keep_unsettled);
  const PatchCosines cosines{1 / radius, patches.cosine, patches.sine};
  make_room(scratch.caps, caps.size());
  ESES_BEST_VERSION(prepare_caps)(caps, cosines, scratch.caps);
  order_by_size(caps.size(), scratch.caps);
  DirectionList& unsettled = scratch.unsettled;
  for (auto* values : {&unsettled.x, &unsettled.y, &unsettled.z})
    values->resize(patches.directions.x.size());
  scratch.relevant.clear();
  scratch.covering.clear();
  std::span<const std::uint32_t> left(scratch.caps.order);
  const DirectionList* from = &patches.directions;
  std::size_t count = patches.count;
  for (const std::size_t caps_at_once : {caps_per_count[0], caps_per_count[1], left.size()}) {
    const std::size_t size = std::min(caps_at_once, left.size());
    count = keep(scratch.caps, left.first(size), *from, count, unsettled);
    if (count == 0) return true;
    from = &unsettled;
    left = left.subspan(size);
  }
  ESES_BEST_VERSION(find_touched)(caps, cosines, scratch.caps);
  ESES_BEST_VERSION(list_kept)(scratch, count);
  return false;
}

}  // namespace eses::detail
#endif  // HWY_ONCE
