#pragma once
/// The box of a region.

#include <algorithm>

#include "eses/grid.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// Returns the box of the points of a region and of the edges that start there.
inline Box region_box(const Grid& grid, const GridRegion& region) {
  Box box{grid.point(region.begin), {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    box.high[axis] = grid.coordinate(axis, std::min(region.end[axis], grid.size[axis] - 1));
  return box;
}

}  // namespace eses::detail
