#pragma once
/// A hierarchy of boxes around points, to find the points near another one.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/box.hpp"

namespace eses::detail {

/// Number of points or boxes in a node of a PointTree.
inline constexpr std::size_t tree_fan_out = 8;
/// One coordinate of each point or box of a node.
using TreeLanes = std::array<double, tree_fan_out>;

/// Boxes of a PointTree. Unused ones are empty.
struct TreeBoxes {
  std::array<TreeLanes, 3> low, high;
};

/// Points of a node of a PointTree. The coordinates of unused ones are infinite.
struct TreePoints {
  std::array<TreeLanes, 3> coordinates;
  std::array<std::uint32_t, tree_fan_out> indices;
};

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
    if (levels_.empty()) return;
    visit({center, distance * distance, best_kernels()}, levels_.size(), 0, action);
  }

 private:
  // Functions that return the boxes or points within a distance as bits, from its square.
  struct Kernels {
    std::uint32_t (*boxes_within)(const TreeBoxes& boxes, Vec3 center, double squared);
    std::uint32_t (*points_within)(const TreePoints& points, Vec3 center, double squared);
  };
  struct Search {
    Vec3 center;
    double squared_distance;
    Kernels kernels;
  };

  static Kernels best_kernels();

  // Level 0 has the points, and level n + 1 the boxes around the nodes of level n.
  template <class Action>
  void visit(const Search& search, std::size_t level, std::size_t node, Action&& action) const {
    const auto& [center, squared, kernels] = search;
    if (level == 0) {
      const TreePoints& points = points_[node];
      for (std::uint32_t bits = kernels.points_within(points, center, squared); bits != 0;
           bits &= bits - 1)
        action(points.indices[static_cast<std::size_t>(std::countr_zero(bits))]);
      return;
    }
    for (std::uint32_t bits = kernels.boxes_within(levels_[level - 1][node], center, squared);
         bits != 0; bits &= bits - 1)
      visit(search, level - 1,
            node * tree_fan_out + static_cast<std::size_t>(std::countr_zero(bits)), action);
  }

  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;  // of the points, sorted
  std::vector<TreePoints> points_;
  std::vector<std::vector<TreeBoxes>> levels_;  // the last one has one element
  std::vector<Box> boxes_;                      // of the nodes of the last level
};

}  // namespace eses::detail
