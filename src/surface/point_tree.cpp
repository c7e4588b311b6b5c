#include "surface/point_tree.hpp"

#include <algorithm>
#include <limits>

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
    const std::size_t lane = k % fan_out;
    const std::uint32_t index = keys_[k].second;
    const Vec3 point = points[index];
    if (lane == 0) {
      Points& added = points_.emplace_back();
      for (Lanes& lanes : added.coordinates) lanes.fill(infinity);
      boxes_.push_back({point, point});
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      points_.back().coordinates[axis][lane] = point[axis];
    points_.back().indices[lane] = index;
    boxes_.back().include(point);
  }
  do {
    std::vector<Boxes> level((boxes_.size() + fan_out - 1) / fan_out);
    for (Boxes& boxes : level)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        boxes.low[axis].fill(infinity);
        boxes.high[axis].fill(-infinity);
      }
    std::vector<Box> around;
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const Box& box = boxes_[k];
      if (k % fan_out == 0) around.push_back(box);
      around.back().include(box.low);
      around.back().include(box.high);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        level[k / fan_out].low[axis][k % fan_out] = box.low[axis];
        level[k / fan_out].high[axis][k % fan_out] = box.high[axis];
      }
    }
    boxes_ = std::move(around);
    levels_.push_back(std::move(level));
  } while (boxes_.size() > 1);
}

}  // namespace eses::detail
