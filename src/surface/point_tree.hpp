#pragma once
/// A hierarchy of boxes around points, to find the points near another one.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/box.hpp"

namespace eses::detail {

/// Boxes around a few points that are near each other, boxes around such boxes, and so on. Unlike a
/// search in cells, the time of a search does not depend on the distance but on the number of
/// points within it.
class PointTree {
 public:
  /// Replaces the points.
  void reset(std::span<const Vec3> points);

  /// Calls `action(index)` for all points whose distance from `center` is less than `distance`
  /// (angstrom). The order depends on the points only.
  template <class Action>
  void for_each_within(Vec3 center, double distance, Action&& action) const {
    if (!levels_.empty()) visit(levels_.size(), 0, center, distance * distance, action);
  }

 private:
  static constexpr std::size_t fan_out = 8;
  using Lanes = std::array<double, fan_out>;

  // Boxes as a structure of arrays, for vector instructions. Unused ones are empty.
  struct Boxes {
    std::array<Lanes, 3> low, high;
  };
  struct Points {
    std::array<Lanes, 3> coordinates;  // infinite if unused
    std::array<std::uint32_t, fan_out> indices;
  };

  static Lanes squared_distances(const Boxes& boxes, Vec3 center) {
    Lanes squared{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double c = center[axis];
      for (std::size_t k = 0; k < fan_out; ++k) {
        const double below = boxes.low[axis][k] - c, above = c - boxes.high[axis][k];
        const double outside = below > above ? below : above;
        const double distance = outside > 0 ? outside : 0;
        squared[k] += distance * distance;
      }
    }
    return squared;
  }
  static Lanes squared_distances(const Points& points, Vec3 center) {
    Lanes squared{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double c = center[axis];
      for (std::size_t k = 0; k < fan_out; ++k) {
        const double offset = points.coordinates[axis][k] - c;
        squared[k] += offset * offset;
      }
    }
    return squared;
  }

  // Level 0 has the points, and level n + 1 the boxes around the nodes of level n.
  template <class Action>
  void visit(std::size_t level, std::size_t node, Vec3 center, double limit,
             Action&& action) const {
    if (level == 0) {
      const Lanes squared = squared_distances(points_[node], center);
      for (std::size_t k = 0; k < fan_out; ++k)
        if (squared[k] < limit) action(points_[node].indices[k]);
      return;
    }
    const Lanes squared = squared_distances(levels_[level - 1][node], center);
    for (std::size_t k = 0; k < fan_out; ++k)
      if (squared[k] < limit) visit(level - 1, node * fan_out + k, center, limit, action);
  }

  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;  // of the points, sorted
  std::vector<Points> points_;
  std::vector<std::vector<Boxes>> levels_;  // the last one has one element
  std::vector<Box> boxes_;                  // of the nodes of the last level
};

}  // namespace eses::detail
