#pragma once
/// Counts of grid points, from which the volume follows.

#include <cstdint>

#include "grid/tiling.hpp"
#include "sweep/layer.hpp"

namespace eses::detail {

struct PointCounts {
  std::int64_t inside = 0;          ///< inside points
  std::int64_t inside_regular = 0;  ///< of these, those that end no reported edge
  std::int64_t irregular = 0;       ///< points, inside or outside, that end one

  void add(const PointCounts& other);
};

/// Counts the points that blocks [begin, end) of the layer own. `below` is the last plane of the
/// layer before, if there is one.
PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         std::int64_t begin, std::int64_t end);

}  // namespace eses::detail
