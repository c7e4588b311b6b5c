#pragma once
/// A hierarchy of boxes around points, to find the points near a place.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"

namespace eses::detail {

/// Boxes around consecutive points, boxes around consecutive boxes, and so on. The search is fast
/// if consecutive points are near each other.
class PointTree {
 public:
  /// Replaces the points. Keeps a view of them.
  void reset(std::span<const Vec3> points);

  /// Calls `action(index)` for all points whose distance from `center` is less than `distance`
  /// (angstrom), in ascending order.
  template <class Action>
  void for_each_within(Vec3 center, double distance, Action&& action) const {
    if (!levels_.empty()) visit(levels_.size() - 1, 0, center, distance * distance, action);
  }

 private:
  static constexpr std::size_t fan_out = 8;

  template <class Action>
  void visit(std::size_t level, std::size_t node, Vec3 center, double squared,
             Action&& action) const {
    if (squared_distance(levels_[level][node], center) >= squared) return;
    const std::size_t begin = node * fan_out;
    const std::size_t size = level == 0 ? points_.size() : levels_[level - 1].size();
    const std::size_t end = begin + fan_out < size ? begin + fan_out : size;
    for (std::size_t k = begin; k < end; ++k) {
      if (level > 0) {
        visit(level - 1, k, center, squared, action);
      } else if (squared_norm(points_[k] - center) < squared) {
        action(static_cast<std::uint32_t>(k));
      }
    }
  }

  std::span<const Vec3> points_;
  std::vector<std::vector<Box>> levels_;  // the last one has one box
};

}  // namespace eses::detail
