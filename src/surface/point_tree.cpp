#include "surface/point_tree.hpp"

#include <algorithm>

namespace eses::detail {

void PointTree::reset(std::span<const Vec3> points) {
  points_ = points;
  levels_.clear();
  if (points.empty()) return;
  auto& leaves = levels_.emplace_back();
  for (std::size_t begin = 0; begin < points.size(); begin += fan_out) {
    Box box{points[begin], points[begin]};
    for (std::size_t k = begin; k < std::min(begin + fan_out, points.size()); ++k)
      box.include(points[k]);
    leaves.push_back(box);
  }
  while (levels_.back().size() > 1) {
    const std::vector<Box>& below = levels_.back();
    std::vector<Box> boxes;
    for (std::size_t begin = 0; begin < below.size(); begin += fan_out) {
      Box box = below[begin];
      for (std::size_t k = begin; k < std::min(begin + fan_out, below.size()); ++k) {
        box.include(below[k].low);
        box.include(below[k].high);
      }
      boxes.push_back(box);
    }
    levels_.push_back(std::move(boxes));
  }
}

}  // namespace eses::detail
