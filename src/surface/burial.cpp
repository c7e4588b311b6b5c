#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/burial.cpp"
#include "surface/burial.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"

#ifndef ESES_SURFACE_BURIAL_SHARED_
#define ESES_SURFACE_BURIAL_SHARED_
namespace eses::detail {
namespace {

// If the height of a cap, relative to the radius, grows by `small_shrinkage`, its angular radius
// changes by at most sqrt(2 small_shrinkage) = 9e-5. For patches of 0.2 radians this changes the
// cosines `settled` and `touched` by at most 2e-5. The slack exceeds this and the rounding errors
// of single-precision dot products, so that a settled patch lies in the cap with certainty.
constexpr double small_shrinkage = 4e-9;
constexpr double float_slack = 3e-5;

// Number of vectors of directions that are tested against a cap at once. This hides the latency of
// the instructions.
constexpr std::size_t vectors_at_once = 4;

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

using Lanes = hn::ScalableTag<float>;

// Directions of patches, one in each lane, and whether a cap settles them.
struct DirectionVector {
  hn::Vec<Lanes> x, y, z;
  hn::Mask<Lanes> unsettled;
};

// Marks the patches that a cap settles, and returns their lanes.
HWY_INLINE hn::Mask<Lanes> settle(const BurialCap& cap, DirectionVector& directions) {
  const Lanes lanes;
  const auto cosine = hn::Add(hn::Add(hn::Mul(directions.x, hn::Set(lanes, cap.x)),
                                      hn::Mul(directions.y, hn::Set(lanes, cap.y))),
                              hn::Mul(directions.z, hn::Set(lanes, cap.z)));
  const auto settled = hn::And(directions.unsettled, hn::Ge(cosine, hn::Set(lanes, cap.settled)));
  directions.unsettled = hn::AndNot(settled, directions.unsettled);
  return settled;
}

// Keeps the directions whose patch no cap settles, and returns their number. Marks the caps that
// settled a patch. The arrays are padded to whole groups of vectors, and compression in place never
// overwrites elements that have not been read.
std::size_t keep_unsettled(std::span<BurialCap> caps, float* x, float* y, float* z,
                           std::size_t count) {
  const Lanes lanes;
  const std::size_t width = hn::Lanes(lanes);
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < count; begin += vectors_at_once * width) {
    const auto load_directions = [&](std::size_t vector) {
      const std::size_t i = begin + vector * width;
      return DirectionVector{hn::LoadU(lanes, x + i), hn::LoadU(lanes, y + i),
                             hn::LoadU(lanes, z + i),
                             hn::FirstN(lanes, count - std::min(count, i))};
    };
    DirectionVector first = load_directions(0), second = load_directions(1),
                    third = load_directions(2), fourth = load_directions(3);
    for (BurialCap& cap : caps) {
      const auto settled = hn::Or(hn::Or(settle(cap, first), settle(cap, second)),
                                  hn::Or(settle(cap, third), settle(cap, fourth)));
      if (hn::AllFalse(lanes, settled)) continue;
      cap.is_used = true;
      if (hn::AllFalse(lanes, hn::Or(hn::Or(first.unsettled, second.unsettled),
                                     hn::Or(third.unsettled, fourth.unsettled))))
        break;
    }
    for (const DirectionVector* directions : {&first, &second, &third, &fourth}) {
      if (hn::AllFalse(lanes, directions->unsettled)) continue;
      const std::size_t n =
          compress_store(lanes, directions->x, directions->unsettled, x + kept);
      compress_store(lanes, directions->y, directions->unsettled, y + kept);
      compress_store(lanes, directions->z, directions->unsettled, z + kept);
      kept += n;
    }
  }
  return kept;
}

// Returns whether one of the first `count` patches is at least at this cosine from the cap's axis.
bool any_above(const BurialCap& cap, float cosine_limit, const BurialScratch& scratch,
               std::size_t count) {
  const Lanes lanes;
  const auto vx = hn::Set(lanes, cap.x), vy = hn::Set(lanes, cap.y), vz = hn::Set(lanes, cap.z);
  const auto limit = hn::Set(lanes, cosine_limit);
  for (std::size_t i = 0; i < count; i += hn::Lanes(lanes)) {
    const auto cosine = hn::Add(hn::Add(hn::Mul(hn::LoadU(lanes, &scratch.x[i]), vx),
                                        hn::Mul(hn::LoadU(lanes, &scratch.y[i]), vy)),
                                hn::Mul(hn::LoadU(lanes, &scratch.z[i]), vz));
    const auto above = hn::And(hn::Ge(cosine, limit), hn::FirstN(lanes, count - i));
    if (!hn::AllFalse(lanes, above)) return true;
  }
  return false;
}

// Lists the caps that may reach one of the `count` remaining patches, and the others that settled a
// patch.
void list_kept(BurialScratch& scratch, std::size_t count) {
  for (const BurialCap& cap : scratch.caps) {
    if (any_above(cap, scratch.touched[cap.number], scratch, count)) {
      scratch.relevant.push_back(cap.number);
    } else if (cap.is_used) {
      scratch.covering.push_back(cap.number);
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

HWY_INLINE void store_floats(DoubleVector values, float* to) {
  const hn::Rebind<float, Doubles> floats;
  hn::StoreU(hn::DemoteTo(floats, values), floats, to);
}

// Computes for each cap the minimum cosine from its axis of patches that lie in it: the cosine of
// the difference of the angular radii of cap and patch, plus slack for rounding.
void find_settled(const CapList& caps, const PatchCosines& patch, float* settled) {
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(Doubles())) {
    const auto height = load(&caps.height[k]), blocking = load(&caps.blocking_height[k]);
    // The slackened cap of a neighbour at almost the same position is nearly empty, so its exact
    // cap must not replace others.
    const auto shrinks =
        (blocking - height) * broadcast(patch.inverse_radius) > broadcast(small_shrinkage);
    const auto [cosine, sine] =
        angular_radius(hn::IfThenElse(shrinks, blocking, height), patch.inverse_radius);
    const auto can_settle = cosine < broadcast(patch.cosine);  // the cap is wider than a patch
    const auto limit =
        cosine * broadcast(patch.cosine) + sine * broadcast(patch.sine) + broadcast(float_slack);
    store_floats(hn::IfThenElse(can_settle, limit, broadcast(2)), settled + k);
  }
}

// Computes for each cap the minimum cosine from its axis of patches that it may reach: the cosine
// of the sum of the angular radii of cap and patch, less slack for rounding.
void find_touched(const CapList& caps, const PatchCosines& patch, float* touched) {
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(Doubles())) {
    const auto [cosine, sine] = angular_radius(load(&caps.height[k]), patch.inverse_radius);
    const auto touches_any =
        cosine <= broadcast(-patch.cosine);  // the cap reaches the opposite patch
    const auto limit =
        cosine * broadcast(patch.cosine) - sine * broadcast(patch.sine) - broadcast(float_slack);
    store_floats(hn::IfThenElse(touches_any, broadcast(-2), limit), touched + k);
  }
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {

namespace {

// Numbers of caps after which the remaining patches are counted. Most buried atoms need no more.
constexpr std::array<std::size_t, 2> caps_per_count{16, 32};

// Caps with a lower minimum cosine settle more patches. They are ordered by this cosine in steps of
// 1/32; within a step they keep their order.
constexpr std::size_t size_steps = 66;

std::size_t size_step(float settled) {
  constexpr float steps_per_unit = 32;
  return static_cast<std::size_t>(
      static_cast<int>(steps_per_unit * (std::clamp(settled, -1.0F, 1.0F) + 1)));
}

// Replaces `ordered` by the caps in the layout of the kernel, the largest ones first.
void order_by_size(const CapList& caps, std::span<const float> settled,
                   std::vector<BurialCap>& ordered) {
  std::array<std::uint32_t, size_steps> next{};
  for (const float cosine : settled) ++next[size_step(cosine) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  ordered.resize(settled.size());
  for (std::uint32_t k = 0; k < settled.size(); ++k)
    ordered[next[size_step(settled[k])]++] = {static_cast<float>(caps.x[k]),
                                              static_cast<float>(caps.y[k]),
                                              static_cast<float>(caps.z[k]),
                                              settled[k],
                                              k,
                                              false};
}

void make_room(std::vector<float>& values, std::size_t count) {
  if (values.size() < count + vector_padding) values.resize(2 * count + vector_padding);
}

}  // namespace

BurialPatches::BurialPatches(const CoveringDirections& covering)
    : cosine(std::cos(covering.radius)), sine(std::sin(covering.radius)) {
  for (const Vec3 direction : covering.directions) {
    x.push_back(static_cast<float>(direction.x));
    y.push_back(static_cast<float>(direction.y));
    z.push_back(static_cast<float>(direction.z));
  }
}

bool is_buried(const CapList& caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch) {
  const auto keep = ESES_BEST_VERSION(keep_unsettled);
  std::size_t count = patches.x.size();
  const auto load = [&](const std::vector<float>& from, std::vector<float>& to) {
    to.resize(from.size() + vectors_at_once * vector_padding);
    std::copy(from.begin(), from.end(), to.begin());
  };
  load(patches.x, scratch.x);
  load(patches.y, scratch.y);
  load(patches.z, scratch.z);

  const PatchCosines cosines{1 / radius, patches.cosine, patches.sine};
  make_room(scratch.settled, caps.size());
  ESES_BEST_VERSION(find_settled)(caps, cosines, scratch.settled.data());
  order_by_size(caps, std::span(scratch.settled).first(caps.size()), scratch.caps);
  scratch.relevant.clear();
  scratch.covering.clear();
  std::span<BurialCap> left(scratch.caps);
  for (const std::size_t caps_at_once : {caps_per_count[0], caps_per_count[1], left.size()}) {
    const std::size_t size = std::min(caps_at_once, left.size());
    count = keep(left.first(size), scratch.x.data(), scratch.y.data(), scratch.z.data(), count);
    if (count == 0) return true;
    left = left.subspan(size);
  }
  make_room(scratch.touched, caps.size());
  ESES_BEST_VERSION(find_touched)(caps, cosines, scratch.touched.data());
  ESES_BEST_VERSION(list_kept)(scratch, count);
  return false;
}

}  // namespace eses::detail
#endif  // HWY_ONCE
