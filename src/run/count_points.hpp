#pragma once
/// Counts of grid points for the volume.

#include <cstdint>

#include "grid/tiling.hpp"
#include "run/layer.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// Counts the points that the blocks [begin, end) of the layer own. `below` is the last plane of
/// the previous layer, without blocks if there is none.
PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         std::int64_t begin, std::int64_t end);

}  // namespace eses::detail
