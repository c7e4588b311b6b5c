#pragma once
/// Counts of grid points for the volume.

#include <cstdint>

#include "grid/tiling.hpp"
#include "sweep/layer.hpp"

namespace eses::detail {

/// Numbers of points. A point is irregular if it is an end of an edge with a crossing.
struct PointCounts {
  std::int64_t inside = 0;          ///< inside points
  std::int64_t inside_regular = 0;  ///< inside points that are not irregular
  std::int64_t irregular = 0;       ///< irregular points, inside or outside

  void add(const PointCounts& other);
};

/// Counts the points that the blocks [begin, end) of the layer own. `below` is the last plane of
/// the previous layer, without blocks if there is none.
PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         std::int64_t begin, std::int64_t end);

}  // namespace eses::detail
