#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/cap_list.cpp"
#include "geometry/cap_list.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/points-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

using Positions = hn::RebindToSigned<Doubles>;

// Stores the positions of the spheres that satisfy `is_selected(offset, radius)`, followed by a
// vector of zeros. `offset` is the vector from `origin` to the sphere's centre. Returns the number
// of selected spheres.
template <class Predicate>
HWY_INLINE std::size_t select_positions(Vec3 origin, const SphereList& spheres,
                                        std::int64_t* positions, Predicate&& is_selected) {
  const Doubles doubles;
  const Positions lanes;
  std::size_t found = 0;
  auto numbers = hn::Iota(lanes, 0);  // of the spheres in the lanes
  const auto next = hn::Set(lanes, static_cast<std::int64_t>(hn::Lanes(doubles)));
  for (std::size_t i = 0; i < spheres.count;
       i += hn::Lanes(doubles), numbers = hn::Add(numbers, next)) {
    const Points offset{load(&spheres.x[i]) - broadcast(origin.x),
                        load(&spheres.y[i]) - broadcast(origin.y),
                        load(&spheres.z[i]) - broadcast(origin.z)};
    const auto selected = is_selected(offset, load(&spheres.radius[i]));
    if (hn::AllFalse(doubles, selected)) continue;
    found += compress_store(lanes, numbers, hn::RebindMask(lanes, selected), positions + found);
  }
  // The last vector may have elements after the last sphere.
  while (found > 0 && positions[found - 1] >= static_cast<std::int64_t>(spheres.count)) --found;
  hn::StoreU(hn::Zero(lanes), lanes, positions + found);
  return found;
}

std::size_t positions_near_box(const Box& box, double distance, const SphereList& spheres,
                               std::int64_t* positions) {
  const Vec3 center = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
  const auto beyond = [](DoubleVector offset, double half_length) {
    return hn::Max(hn::Abs(offset) - broadcast(half_length), broadcast(0));
  };
  return select_positions(
      center, spheres, positions, [&](const Points& offset, DoubleVector radius) {
        const auto reach = broadcast(distance) + radius;
        return squared_norm(Points{beyond(offset.x, half.x), beyond(offset.y, half.y),
                                   beyond(offset.z, half.z)}) < reach * reach;
      });
}

void copy_at_positions(const SphereList& spheres, const std::int64_t* positions,
                       SphereList& chosen) {
  const Doubles doubles;
  for (std::size_t k = 0; k < chosen.count; k += hn::Lanes(doubles)) {
    const auto at = hn::LoadU(Positions(), positions + k);
    const auto copy = [&](const std::vector<double>& from, std::vector<double>& to) {
      hn::StoreU(hn::GatherIndex(doubles, from.data(), at), doubles, &to[k]);
    };
    copy(spheres.x, chosen.x);
    copy(spheres.y, chosen.y);
    copy(spheres.z, chosen.z);
    copy(spheres.radius, chosen.radius);
  }
}

// Returns the number of caps.
std::size_t caps_at_positions(const SasSphere& sphere, const SphereList& spheres,
                              const std::vector<std::int32_t>& near, std::size_t count,
                              double min_overlap, std::int64_t* positions, CapList& caps) {
  const Doubles doubles;
  const hn::Rebind<std::int32_t, Doubles> short_lanes;
  const Positions positions_lanes;
  std::size_t made = 0;
  for (std::size_t k = 0; k < count; k += hn::Lanes(doubles)) {
    const auto at = hn::PromoteTo(positions_lanes, hn::LoadU(short_lanes, &near[k]));
    const auto gather = [&](const std::vector<double>& from) {
      return hn::GatherIndex(doubles, from.data(), at);
    };
    const Points to_neighbour{gather(spheres.x) - broadcast(sphere.center.x),
                              gather(spheres.y) - broadcast(sphere.center.y),
                              gather(spheres.z) - broadcast(sphere.center.z)};
    const auto radius = gather(spheres.radius);
    const auto squared = squared_norm(to_neighbour);
    const auto reach = broadcast(sphere.radius) + radius - broadcast(min_overlap);
    const auto meets = hn::And(hn::And(squared<reach * reach, squared> broadcast(0)),
                               hn::FirstN(doubles, count - k));
    const auto inverse = broadcast(1) / hn::Sqrt(squared);
    const auto height =
        broadcast(0.5) * inverse *
        (squared + (broadcast(sphere.radius) - radius) * (broadcast(sphere.radius) + radius));
    const Points axis = inverse * to_neighbour;
    const auto keep = [&](DoubleVector values, std::vector<double>& to) {
      return compress_store(doubles, values, meets, &to[made]);
    };
    keep(axis.x, caps.x);
    keep(axis.y, caps.y);
    keep(axis.z, caps.z);
    keep(height + broadcast(tolerance::accessible) * radius * inverse, caps.blocking_height);
    compress_store(positions_lanes, at, hn::RebindMask(positions_lanes, meets), positions + made);
    made += keep(height, caps.height);
  }
  return made;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// Most lists have a few hundred elements.
constexpr std::size_t min_capacity = 512;

// Returns the array size for a list of `capacity` elements, or 0 if `size` is sufficient.
std::size_t grown_size(std::size_t size, std::size_t capacity) {
  if (capacity + vector_padding <= size) return 0;
  return std::max({2 * size, capacity, min_capacity}) + vector_padding;
}

// Makes room for all positions, one vector that is stored as a whole, and one vector of zeros.
void make_room(SpherePositions& positions, std::size_t count) {
  const std::size_t size = count + 2 * vector_padding;
  if (positions.at.size() < size) positions.at.resize(2 * size);
}

}  // namespace

void SphereList::make_room(std::size_t capacity) {
  const std::size_t size = grown_size(x.size(), capacity);
  if (size == 0) return;
  for (auto* component : {&x, &y, &z, &radius}) component->resize(size);
}

void CapList::make_room(std::size_t capacity) {
  const std::size_t size = grown_size(x.size(), capacity);
  if (size == 0) return;
  for (auto* component : {&x, &y, &z, &height, &blocking_height}) component->resize(size);
}

void find_near_box(const Box& box, double distance, const SphereList& spheres,
                   SpherePositions& positions) {
  make_room(positions, spheres.count);
  positions.count =
      ESES_BEST_VERSION(positions_near_box)(box, distance, spheres, positions.at.data());
}

void choose_spheres(const SphereList& spheres, const SpherePositions& positions,
                    SphereList& chosen) {
  chosen.make_room(positions.count);
  chosen.count = positions.count;
  ESES_BEST_VERSION(copy_at_positions)(spheres, positions.at.data(), chosen);
}

void make_caps(const SasSphere& sphere, const SphereList& spheres,
               const std::vector<std::int32_t>& near, std::size_t count, double min_overlap,
               SpherePositions& positions, CapList& caps) {
  caps.make_room(count);
  make_room(positions, count);
  caps.count = positions.count = ESES_BEST_VERSION(caps_at_positions)(
      sphere, spheres, near, count, min_overlap, positions.at.data(), caps);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
