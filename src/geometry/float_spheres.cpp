#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/float_spheres.cpp"
#include "geometry/float_spheres.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"
#include "system/padding.hpp"

#ifndef ESES_GEOMETRY_FLOAT_SPHERES_SHARED_
#define ESES_GEOMETRY_FLOAT_SPHERES_SHARED_
namespace eses::detail {
namespace {

// The largest coordinate and radius of a list (angstrom).
struct Extent {
  double coordinate, radius;
};

}  // namespace
}  // namespace eses::detail
#endif  // ESES_GEOMETRY_FLOAT_SPHERES_SHARED_

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

using Positions = hn::Repartition<std::int32_t, Floats>;

// The centres of spheres relative to a point, one in each lane.
struct FloatOffsets {
  FloatVector x, y, z;

  HWY_INLINE FloatVector squared_norm() const {
    return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
  }
};

HWY_INLINE FloatOffsets offsets_from(Vec3 point, const FloatSpheres& spheres, std::size_t first) {
  const Floats floats;
  return {hn::Sub(hn::LoadU(floats, &spheres.x[first]), broadcast_float(point.x)),
          hn::Sub(hn::LoadU(floats, &spheres.y[first]), broadcast_float(point.y)),
          hn::Sub(hn::LoadU(floats, &spheres.z[first]), broadcast_float(point.z))};
}

// Returns which of the spheres from `first` have their centre nearer than `distance` and the
// sphere's radius, given the squared distances.
HWY_INLINE FloatMask are_within(double distance, FloatVector squared, const FloatSpheres& spheres,
                                std::size_t first) {
  const Floats floats;
  const auto reach = hn::Add(hn::LoadU(floats, &spheres.radius[first]), broadcast_float(distance));
  return hn::And(hn::Lt(squared, hn::Mul(reach, reach)), hn::FirstN(floats, spheres.count - first));
}

Extent convert(const SphereList& spheres, FloatSpheres& floats) {
  const Doubles doubles;
  const hn::Rebind<float, Doubles> halves;
  const hn::Rebind<std::int32_t, Doubles> positions;
  auto coordinate = broadcast(0), radius = broadcast(0);
  const auto lanes = hn::Iota(positions, 0);
  for (std::size_t k = 0; k < spheres.count; k += hn::Lanes(doubles)) {
    const auto is_used = hn::FirstN(doubles, spheres.count - k);
    const auto store = [&](DoubleVector values, DoubleVector& max, std::vector<float>& to) {
      max = hn::Max(max, hn::IfThenElseZero(is_used, hn::Abs(values)));
      hn::StoreU(hn::DemoteTo(halves, values), halves, &to[k]);
    };
    store(load(&spheres.x[k]) - broadcast(floats.origin.x), coordinate, floats.x);
    store(load(&spheres.y[k]) - broadcast(floats.origin.y), coordinate, floats.y);
    store(load(&spheres.z[k]) - broadcast(floats.origin.z), coordinate, floats.z);
    store(load(&spheres.radius[k]), radius, floats.radius);
    hn::StoreU(hn::Add(lanes, hn::Set(positions, static_cast<std::int32_t>(k))), positions,
               &floats.position[k]);
  }
  return {hn::GetLane(hn::MaxOfLanes(doubles, coordinate)),
          hn::GetLane(hn::MaxOfLanes(doubles, radius))};
}

void choose(const Box& box, double distance, const FloatSpheres& spheres, FloatSpheres& chosen) {
  const Floats floats;
  const Positions positions;
  const Vec3 center = 0.5 * (box.low + box.high) - spheres.origin;
  const Vec3 half = 0.5 * (box.high - box.low);
  const auto beyond = [](FloatVector offset, double half_length) {
    return hn::Max(hn::Sub(hn::Abs(offset), broadcast_float(half_length)), hn::Zero(Floats()));
  };
  chosen.count = 0;
  for (std::size_t k = 0; k < spheres.count; k += hn::Lanes(floats)) {
    const FloatOffsets offsets = offsets_from(center, spheres, k);
    const FloatOffsets outside{beyond(offsets.x, half.x), beyond(offsets.y, half.y),
                               beyond(offsets.z, half.z)};
    const FloatMask within = are_within(distance, outside.squared_norm(), spheres, k);
    if (hn::AllFalse(floats, within)) continue;
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
      return compress_store(floats, hn::LoadU(floats, &from[k]), within, &to[chosen.count]);
    };
    copy(spheres.x, chosen.x);
    copy(spheres.y, chosen.y);
    copy(spheres.z, chosen.z);
    compress_store(positions, hn::LoadU(positions, &spheres.position[k]),
                   hn::RebindMask(positions, within), &chosen.position[chosen.count]);
    chosen.count += copy(spheres.radius, chosen.radius);
  }
}

std::size_t find_within(const SasSphere& sphere, const FloatSpheres& spheres, std::int32_t* found) {
  const Positions positions;
  const Vec3 center = sphere.center - spheres.origin;
  const double reach = sphere.radius + spheres.slack;
  std::size_t count = 0;
  for (std::size_t k = 0; k < spheres.count; k += hn::Lanes(positions)) {
    const FloatMask within =
        are_within(reach, offsets_from(center, spheres, k).squared_norm(), spheres, k);
    count += compress_store(positions, hn::LoadU(positions, &spheres.position[k]),
                            hn::RebindMask(positions, within), found + count);
  }
  hn::StoreU(hn::Zero(positions), positions, found + count);
  return count;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// With u = 2^-24, coordinates up to D relative to the origin and radii up to R, distances are off
// by less than 13 u D + 6 u D + 12 u R, see doc/algorithm.md.
constexpr double relative_slack = 0x1p-19;

}  // namespace

void FloatSpheres::make_room(std::size_t capacity) {
  if (capacity + vector_padding <= x.size()) return;
  const std::size_t size = 2 * capacity + vector_padding;
  for (auto* values : {&x, &y, &z, &radius}) values->resize(size);
  position.resize(size);
}

void FloatSpheres::assign(const SphereList& spheres, const Box& around) {
  make_room(spheres.count);
  count = spheres.count;
  origin = 0.5 * (around.low + around.high);
  const Vec3 half = 0.5 * (around.high - around.low);
  const Extent extent = ESES_BEST_VERSION(convert)(spheres, *this);
  slack = relative_slack * (std::max({extent.coordinate, half.x, half.y, half.z}) + extent.radius);
}

void choose_near_box(const Box& box, double distance, const FloatSpheres& spheres,
                     FloatSpheres& chosen) {
  chosen.make_room(spheres.count);
  chosen.origin = spheres.origin;
  chosen.slack = spheres.slack;
  ESES_BEST_VERSION(choose)(box, distance + spheres.slack, spheres, chosen);
}

std::size_t find_near_sphere(const SasSphere& sphere, const FloatSpheres& spheres,
                             std::vector<std::int32_t>& positions) {
  const std::size_t size = spheres.count + 2 * vector_padding;
  if (positions.size() < size) positions.resize(2 * size);
  return ESES_BEST_VERSION(find_within)(sphere, spheres, positions.data());
}

}  // namespace eses::detail
#endif  // HWY_ONCE
