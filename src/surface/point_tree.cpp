#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/point_tree.cpp"
#include "surface/point_tree.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "system/dispatch.hpp"
#include "system/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Returns the lanes in which the sum of `squares_along(axis, lane)` is less than `limit`, as bits.
template <class Squares>
HWY_INLINE std::uint32_t lanes_within(double limit, Squares&& squares_along) {
  std::uint32_t bits = 0;
  for (std::size_t lane = 0; lane < tree_fan_out; lane += hn::Lanes(Doubles())) {
    const auto squared = squares_along(0, lane) + squares_along(1, lane) + squares_along(2, lane);
    bits |= mask_bits(Doubles(), squared < broadcast(limit)) << lane;
  }
  return bits;
}

std::uint32_t boxes_within(const TreeBoxes& boxes, Vec3 center, double limit) {
  return lanes_within(limit, [&](std::size_t axis, std::size_t lane) {
    const auto c = broadcast(center[axis]);
    const auto outside =
        hn::Max(load(&boxes.low[axis][lane]) - c, c - load(&boxes.high[axis][lane]));
    const auto distance = hn::Max(outside, broadcast(0));
    return distance * distance;
  });
}

std::uint32_t points_within(const TreePoints& points, Vec3 center, double limit) {
  return lanes_within(limit, [&](std::size_t axis, std::size_t lane) {
    const auto offset = load(&points.coordinates[axis][lane]) - broadcast(center[axis]);
    return offset * offset;
  });
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
namespace {

// Side of the cells by which the points are sorted (angstrom).
constexpr double cell_side = 2;
constexpr double max_cell = 0x1fffff;  // 21 bits

// Moves bit k to bit 3 k, for 21 bits.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

// Returns the index of a point's cell along a curve on which neighbouring cells mostly have similar
// indices (G. M. Morton, IBM Technical Report, 1966).
std::uint64_t morton_key(Vec3 point, Vec3 low) {
  std::uint64_t key = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = std::clamp((point[axis] - low[axis]) / cell_side, 0.0, max_cell);
    key |= spread(static_cast<std::uint64_t>(cell)) << axis;
  }
  return key;
}

}  // namespace

PointTree::Kernels PointTree::best_kernels() {
  return {ESES_BEST_VERSION(boxes_within), ESES_BEST_VERSION(points_within)};
}

void PointTree::reset(std::span<const Vec3> points) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  keys_.clear();
  points_.clear();
  boxes_.clear();
  levels_.clear();
  if (points.empty()) return;
  Box all{points.front(), points.front()};
  for (const Vec3 point : points) all.include(point);
  for (std::uint32_t k = 0; k < points.size(); ++k)
    keys_.emplace_back(morton_key(points[k], all.low), k);
  std::sort(keys_.begin(), keys_.end());

  for (std::size_t k = 0; k < keys_.size(); ++k) {
    const std::size_t lane = k % tree_fan_out;
    const std::uint32_t index = keys_[k].second;
    const Vec3 point = points[index];
    if (lane == 0) {
      TreePoints& added = points_.emplace_back();
      for (TreeLanes& lanes : added.coordinates) lanes.fill(infinity);
      boxes_.push_back({point, point});
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      points_.back().coordinates[axis][lane] = point[axis];
    points_.back().indices[lane] = index;
    boxes_.back().include(point);
  }
  do {
    std::vector<TreeBoxes> level((boxes_.size() + tree_fan_out - 1) / tree_fan_out);
    for (TreeBoxes& boxes : level)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        boxes.low[axis].fill(infinity);
        boxes.high[axis].fill(-infinity);
      }
    std::vector<Box> around;
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const Box& box = boxes_[k];
      if (k % tree_fan_out == 0) around.push_back(box);
      around.back().include(box.low);
      around.back().include(box.high);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        level[k / tree_fan_out].low[axis][k % tree_fan_out] = box.low[axis];
        level[k / tree_fan_out].high[axis][k % tree_fan_out] = box.high[axis];
      }
    }
    boxes_ = std::move(around);
    levels_.push_back(std::move(level));
  } while (boxes_.size() > 1);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
