#pragma once
/// Axis-aligned boxes in space.

#include <algorithm>
#include <cstddef>

#include "eses/vec3.hpp"

namespace eses::detail {

/// A closed box; `low` and `high` are opposite corners, in angstrom.
struct Box {
  Vec3 low, high;

  /// Extends the box so that it contains `p`.
  void include(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

/// Returns the box extended by `by` angstrom on all six sides.
inline Box grown(const Box& box, double by) {
  const Vec3 d{by, by, by};
  return {box.low - d, box.high + d};
}

/// Returns the bounding box of a ball.
inline Box ball_box(Vec3 center, double radius) { return grown({center, center}, radius); }

/// Returns whether two boxes have a common point.
inline bool overlap(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && a.high.x >= b.low.x && a.low.y <= b.high.y && a.high.y >= b.low.y &&
         a.low.z <= b.high.z && a.high.z >= b.low.z;
}

/// Returns the common part of two boxes that overlap.
inline Box intersection(const Box& a, const Box& b) {
  Box common;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    common.low[axis] = std::max(a.low[axis], b.low[axis]);
    common.high[axis] = std::min(a.high[axis], b.high[axis]);
  }
  return common;
}

/// Returns whether `p` is in the box.
inline bool contains(const Box& box, Vec3 p) {
  return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y &&
         p.z >= box.low.z && p.z <= box.high.z;
}

/// Returns the squared distance of `p` from the box, in square angstrom; 0 inside.
inline double squared_distance(const Box& box, Vec3 p) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double d = std::max({box.low[axis] - p[axis], p[axis] - box.high[axis], 0.0});
    sum += d * d;
  }
  return sum;
}

}  // namespace eses::detail
