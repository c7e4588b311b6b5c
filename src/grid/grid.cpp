#include "eses/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "eses/error.hpp"

namespace eses {

SphereBounds sphere_bounds(std::span<const Atom> atoms) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  SphereBounds bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Atom& atom : atoms) {
      bounds.low[axis] = std::min(bounds.low[axis], atom.center[axis] - atom.radius);
      bounds.high[axis] = std::max(bounds.high[axis], atom.center[axis] + atom.radius);
    }
  }
  return bounds;
}

Grid make_grid(std::span<const Atom> atoms, double spacing, double margin) {
  return make_grid(sphere_bounds(atoms), spacing, margin);
}

Grid make_grid(const SphereBounds& bounds, double spacing, double margin) {
  if (bounds.low.x > bounds.high.x) throw Error("there are no atoms to build a grid around");
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw Error(fmt::format("spacing must be a positive number of angstrom, not {}", spacing));
  if (!(margin >= 0) || !std::isfinite(margin))
    throw Error(fmt::format("margin must be a non-negative number of angstrom, not {}", margin));
  Grid grid;
  grid.spacing = spacing;
  double points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = bounds.low[axis] - margin, high = bounds.high[axis] + margin;
    // A coordinate must tell neighbouring points apart, and 64-bit products must not overflow.
    const double cells = (high - low) / spacing;
    if (!(cells < 2e9))
      throw Error(
          fmt::format("a spacing of {} angstrom needs {:.3g} grid points along {}; "
                      "the limit is 2e9, so use a spacing above {:.3g}",
                      spacing, cells, "xyz"[axis], (high - low) / 2e9));
    points *= cells + 1;
    grid.size[axis] = static_cast<std::int64_t>(cells) + 1;
    grid.lower[axis] = low;
    grid.upper[axis] = low + static_cast<double>(grid.size[axis] - 1) * spacing;
  }
  if (points > 1e17)
    throw Error(fmt::format("a spacing of {} angstrom needs {:.3g} grid points; the limit is 1e17",
                            spacing, points));
  return grid;
}

GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high) {
  GridRegion region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(low[axis]) || !std::isfinite(high[axis]))
      throw Error(fmt::format("the region goes from {} to {} along {}; its bounds must be finite",
                              low[axis], high[axis], "xyz"[axis]));
    const auto size = grid.size[axis];
    // Near the place that the quotient tells, the coordinates themselves decide.
    const auto near = [&](double coordinate) {
      const double place = (coordinate - grid.lower[axis]) / grid.spacing;
      return static_cast<std::int64_t>(std::clamp(place, -2.0, static_cast<double>(size) + 1));
    };
    std::int64_t begin = std::clamp<std::int64_t>(near(low[axis]) - 2, 0, size);
    while (begin < size && grid.coordinate(axis, begin) < low[axis]) ++begin;
    std::int64_t end = std::clamp<std::int64_t>(near(high[axis]) + 3, 0, size);
    while (end > 0 && grid.coordinate(axis, end - 1) > high[axis]) --end;
    if (!(begin < end))
      throw Error(fmt::format(
          "the region from {} to {} along {} holds no point of the grid, whose "
          "{} points go from {} to {}",
          low[axis], high[axis], "xyz"[axis], size, grid.lower[axis], grid.upper[axis]));
    region.begin[axis] = begin;
    region.end[axis] = end;
  }
  return region;
}

double cut_depth(const Grid& grid, const SphereBounds& bounds) {
  double depth = -std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis)
    depth = std::max(
        {depth, grid.lower[axis] - bounds.low[axis], bounds.high[axis] - grid.upper[axis]});
  return depth;
}

}  // namespace eses
