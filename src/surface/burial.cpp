#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/burial.cpp"
#include "surface/burial.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "simd/dispatch.hpp"
#include "simd/padding.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<float>;

// Keeps the directions whose patch is settled by none of the caps, and returns how many they are;
// marks the caps that settled one. The arrays are padded to whole vectors; compressing in place
// writes behind what was read.
std::size_t keep_unsettled(std::span<BurialCap> caps, float* x, float* y, float* z,
                           std::size_t count) {
  const Lanes lanes;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(lanes)) {
    const auto px = hn::LoadU(lanes, x + i), py = hn::LoadU(lanes, y + i),
               pz = hn::LoadU(lanes, z + i);
    auto unsettled = hn::FirstN(lanes, count - i);
    for (BurialCap& cap : caps) {
      const auto cosine =
          hn::Add(hn::Add(hn::Mul(px, hn::Set(lanes, cap.x)), hn::Mul(py, hn::Set(lanes, cap.y))),
                  hn::Mul(pz, hn::Set(lanes, cap.z)));
      const auto settled = hn::And(unsettled, hn::Ge(cosine, hn::Set(lanes, cap.settled)));
      if (hn::AllFalse(lanes, settled)) continue;
      cap.is_used = true;
      unsettled = hn::AndNot(settled, unsettled);
      if (hn::AllFalse(lanes, unsettled)) break;
    }
    if (hn::AllFalse(lanes, unsettled)) continue;
    const std::size_t n = hn::CompressStore(px, unsettled, lanes, x + kept);
    hn::CompressStore(py, unsettled, lanes, y + kept);
    hn::CompressStore(pz, unsettled, lanes, z + kept);
    kept += n;
  }
  return kept;
}

bool any_above(float ax, float ay, float az, float cosine_limit, const float* x, const float* y,
               const float* z, std::size_t count) {
  const Lanes lanes;
  const auto vx = hn::Set(lanes, ax), vy = hn::Set(lanes, ay), vz = hn::Set(lanes, az);
  const auto limit = hn::Set(lanes, cosine_limit);
  for (std::size_t i = 0; i < count; i += hn::Lanes(lanes)) {
    const auto cosine =
        hn::Add(hn::Add(hn::Mul(hn::LoadU(lanes, x + i), vx), hn::Mul(hn::LoadU(lanes, y + i), vy)),
                hn::Mul(hn::LoadU(lanes, z + i), vz));
    const auto above = hn::And(hn::Ge(cosine, limit), hn::FirstN(lanes, count - i));
    if (!hn::AllFalse(lanes, above)) return true;
  }
  return false;
}

}  // namespace eses::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses {

namespace {

// If the height of a cap, relative to the radius, grows by `small_shrinkage`, its rim turns by at
// most sqrt(2 small_shrinkage) = 9e-5, which changes the cosines at which a patch of 0.2 radians is
// settled or touched by at most 2e-5. The slack covers this and the rounding of single-precision
// dot products, so that a patch is settled for certain.
constexpr double small_shrinkage = 4e-9;
constexpr double float_slack = 3e-5;
// Past the largest caps the order hardly matters, and a full sort would cost more than it saves.
constexpr std::ptrdiff_t sorted_caps = 16;

// cos(angle -+ patch radius) for the angular radius of a cap, with room for rounding.
struct PatchLimits {
  double settled, touched;
};

PatchLimits patch_limits(double cap_cosine, double patch_cosine, double patch_sine) {
  const double cosine = std::clamp(cap_cosine, -1.0, 1.0);
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  const bool can_settle = cosine < patch_cosine;     // the cap is wider than a patch
  const bool touches_any = cosine <= -patch_cosine;  // it reaches to the opposite patch
  return {can_settle ? cosine * patch_cosine + sine * patch_sine + float_slack : 2.0,
          touches_any ? -2.0 : cosine * patch_cosine - sine * patch_sine - float_slack};
}

// A cap settles the more patches the lower the cosine that settles one.
bool is_larger(const BurialCap& a, const BurialCap& b) {
  return a.settled < b.settled || (a.settled == b.settled && a.number < b.number);
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

bool is_buried(std::span<const Cap> caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch) {
  const auto keep = ESES_BEST_VERSION(keep_unsettled);
  const auto touches = ESES_BEST_VERSION(any_above);
  std::size_t count = patches.x.size();
  const auto load = [&](const std::vector<float>& from, std::vector<float>& to) {
    to.resize(count + vector_padding);
    std::copy(from.begin(), from.end(), to.begin());
  };
  load(patches.x, scratch.x);
  load(patches.y, scratch.y);
  load(patches.z, scratch.z);

  const double inverse_radius = 1 / radius;
  auto& order = scratch.order;
  order.clear();
  for (std::uint32_t k = 0; k < caps.size(); ++k) {
    const auto& [axis, height, blocking_height] = caps[k];
    auto [settled, touched] = patch_limits(height * inverse_radius, patches.cosine, patches.sine);
    // A neighbour in almost the same place blocks next to nothing within the tolerance: its cap
    // must not stand for others.
    if ((blocking_height - height) * inverse_radius > small_shrinkage)
      settled =
          patch_limits(blocking_height * inverse_radius, patches.cosine, patches.sine).settled;
    order.push_back({static_cast<float>(axis.x), static_cast<float>(axis.y),
                     static_cast<float>(axis.z), static_cast<float>(settled),
                     static_cast<float>(touched), k, false});
  }
  if (order.size() > sorted_caps)
    std::nth_element(order.begin(), order.begin() + sorted_caps, order.end(), is_larger);
  std::sort(order.begin(), order.begin() + std::min(sorted_caps, std::ssize(order)), is_larger);
  scratch.relevant.clear();
  scratch.covering.clear();
  const std::span all(order);
  const std::size_t largest = std::min<std::size_t>(sorted_caps, order.size());
  for (const auto caps_of_size : {all.first(largest), all.subspan(largest)}) {
    count = keep(caps_of_size, scratch.x.data(), scratch.y.data(), scratch.z.data(), count);
    if (count == 0) return true;
  }
  for (const BurialCap& cap : order) {
    if (touches(cap.x, cap.y, cap.z, cap.touched, scratch.x.data(), scratch.y.data(),
                scratch.z.data(), count)) {
      scratch.relevant.push_back(cap.number);
    } else if (cap.is_used) {
      scratch.covering.push_back(cap.number);
    }
  }
  return false;
}

}  // namespace eses
#endif  // HWY_ONCE
