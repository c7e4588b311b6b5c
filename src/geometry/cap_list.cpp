#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/cap_list.cpp"
#include "geometry/cap_list.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "simd/dispatch.hpp"
#include "simd/lanes-inl.hpp"
#include "simd/padding.hpp"
#include "simd/points-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::HWY_NAMESPACE {

using Positions = hn::RebindToSigned<Doubles>;

std::size_t meeting_positions(const SasSphere& sphere, const SphereList& spheres,
                              std::int64_t* positions) {
  const Doubles doubles;
  const Positions lanes;
  std::size_t found = 0;
  for (std::size_t i = 0; i < spheres.count; i += hn::Lanes(doubles)) {
    const Points offset{load(&spheres.x[i]) - all(sphere.center.x),
                        load(&spheres.y[i]) - all(sphere.center.y),
                        load(&spheres.z[i]) - all(sphere.center.z)};
    const auto squared = squared_norm(offset);
    const auto reach = all(sphere.radius) + load(&spheres.radius[i]) - all(tolerance::containment);
    const auto meets = hn::And(hn::And(squared<reach * reach, squared> all(0)),
                               hn::FirstN(doubles, spheres.count - i));
    if (hn::AllFalse(doubles, meets)) continue;
    found += hn::CompressStore(hn::Iota(lanes, static_cast<std::int64_t>(i)),
                               hn::RebindMask(lanes, meets), lanes, positions + found);
  }
  hn::StoreU(hn::Zero(lanes), lanes, positions + found);
  return found;
}

void caps_at_positions(const SasSphere& sphere, const SphereList& spheres,
                       const std::int64_t* positions, CapList& caps) {
  const Doubles doubles;
  for (std::size_t k = 0; k < caps.count; k += hn::Lanes(doubles)) {
    const auto at = hn::LoadU(Positions(), positions + k);
    const auto gather = [&](const std::vector<double>& from) {
      return hn::GatherIndex(doubles, from.data(), at);
    };
    const Points to_neighbour{gather(spheres.x) - all(sphere.center.x),
                              gather(spheres.y) - all(sphere.center.y),
                              gather(spheres.z) - all(sphere.center.z)};
    const auto radius = gather(spheres.radius);
    const auto squared = squared_norm(to_neighbour);
    const auto inverse = all(1) / hn::Sqrt(squared);
    const auto height = all(0.5) * inverse *
                        (squared + (all(sphere.radius) - radius) * (all(sphere.radius) + radius));
    const Points axis = inverse * to_neighbour;
    hn::StoreU(axis.x, doubles, &caps.x[k]);
    hn::StoreU(axis.y, doubles, &caps.y[k]);
    hn::StoreU(axis.z, doubles, &caps.z[k]);
    hn::StoreU(height, doubles, &caps.height[k]);
    hn::StoreU(height + all(tolerance::accessible) * radius * inverse, doubles,
               &caps.blocking_height[k]);
  }
}

}  // namespace eses::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses {
namespace {

// Lists of a few hundred elements are usual.
constexpr std::size_t min_capacity = 512;

// Elements that the arrays must have for a list of `capacity`, or 0 if they have as many.
std::size_t grown_size(std::size_t size, std::size_t capacity) {
  if (capacity + vector_padding <= size) return 0;
  return std::max({2 * size, capacity, min_capacity}) + vector_padding;
}

}  // namespace

void SphereList::make_room(std::size_t capacity) {
  const std::size_t size = grown_size(x.size(), capacity);
  if (size == 0) return;
  for (auto* component : {&x, &y, &z, &radius}) component->resize(size);
}

void SphereList::push_back(const SasSphere& sphere) {
  make_room(count + 1);
  x[count] = sphere.center.x;
  y[count] = sphere.center.y;
  z[count] = sphere.center.z;
  radius[count] = sphere.radius;
  ++count;
}

void CapList::make_room(std::size_t capacity) {
  const std::size_t size = grown_size(x.size(), capacity);
  if (size == 0) return;
  for (auto* component : {&x, &y, &z, &height, &blocking_height}) component->resize(size);
}

void CapList::push_back(const Cap& cap) {
  make_room(count + 1);
  x[count] = cap.axis.x;
  y[count] = cap.axis.y;
  z[count] = cap.axis.z;
  height[count] = cap.height;
  blocking_height[count] = cap.blocking_height;
  ++count;
}

void find_meeting(const SasSphere& sphere, const SphereList& spheres, SpherePositions& positions) {
  // A vector of zeros follows a vector that is stored as a whole.
  const std::size_t size = spheres.count + 2 * vector_padding;
  if (positions.at.size() < size) positions.at.resize(2 * size);
  positions.count = ESES_BEST_VERSION(meeting_positions)(sphere, spheres, positions.at.data());
}

void make_caps(const SasSphere& sphere, const SphereList& spheres, const SpherePositions& positions,
               CapList& caps) {
  caps.make_room(positions.count);
  caps.count = positions.count;
  ESES_BEST_VERSION(caps_at_positions)(sphere, spheres, positions.at.data(), caps);
}

}  // namespace eses
#endif  // HWY_ONCE
