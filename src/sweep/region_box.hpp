#pragma once
/// Where in space the points of a region and the edges that start there lie.

#include <algorithm>

#include "eses/grid.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

inline Box region_box(const Grid& grid, const GridRegion& region) {
  Box box{grid.point(region.begin), {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    box.high[axis] = grid.coordinate(axis, std::min(region.end[axis], grid.size[axis] - 1));
  return box;
}

}  // namespace eses::detail
