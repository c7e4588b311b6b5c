#include "geometry/make_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/read_number.hpp"

namespace eses::detail {
namespace {

// With this limit and `max_point_count`, coordinates distinguish neighbouring points, and 64-bit
// products do not overflow.
constexpr double max_cells_along_axis = 2e9;

// Numbers of spacings from the origin of a chosen grid to any atom are 64-bit integers.
constexpr double min_spacing = 1e-9;

// Bound of the rounding errors of the distance between a point on a face of the grid and a van der
// Waals sphere, in units of the largest coordinate: those of the point, of the bounding box, and of
// the classification of the point are a few units in the last place each.
constexpr double face_rounding = 16 * std::numeric_limits<double>::epsilon();

double cells_along(const Box& box, double spacing, std::size_t axis) {
  return (box.high[axis] - box.low[axis]) / spacing;
}

// Returns an upper bound for the number of points.
double points_in(const Box& box, double spacing) {
  double points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) points *= cells_along(box, spacing, axis) + 1;
  return points;
}

// Returns the margin to use with a spacing. A margin below half the spacing could cut the molecule.
double margin_for(double spacing, double margin) {
  return margin >= 0.5 * spacing ? margin : spacing;
}

bool is_possible(const Box& bounds, double spacing, double margin) {
  const Box box = grown(bounds, margin_for(spacing, margin));
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(cells_along(box, spacing, axis) < max_cells_along_axis)) return false;
  return points_in(box, spacing) <= max_point_count;
}

// Returns the number that is printed with three significant digits, so that users can copy it.
double three_digits(int digits, int exponent) {
  const std::string text = formatted("{}e{}", digits, exponent);
  double value = 0;
  read_number(text, value);
  return value;
}

// Returns advice for a spacing that gives too many points: the smallest possible spacing, rounded
// up.
std::string spacing_advice(const Box& bounds, double spacing, double margin) {
  constexpr int max_exponent = 300;
  int exponent = static_cast<int>(std::floor(std::log10(spacing))) - 2, digits = 100;
  while (exponent <= max_exponent && !is_possible(bounds, three_digits(999, exponent), margin))
    ++exponent;
  if (exponent > max_exponent) return "use a smaller margin";
  while (!is_possible(bounds, three_digits(digits, exponent), margin)) ++digits;
  const double possible = three_digits(digits, exponent), wider = margin_for(possible, margin);
  return formatted("use a spacing of at least {}{}", possible,
                   wider == margin ? "" : formatted(" and a margin of at least {}", wider));
}

}  // namespace

Box sphere_bounds(std::span<const Atom> atoms) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box bounds{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
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

Grid make_grid(const Box& bounds, double spacing, double margin) {
  if (bounds.low.x > bounds.high.x)
    throw std::invalid_argument("there are no atoms to build a grid around");
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw std::invalid_argument(
        formatted("spacing must be a positive number of angstrom, not {}", spacing));
  if (!(margin >= 0) || !std::isfinite(margin))
    throw std::invalid_argument(
        formatted("margin must be a non-negative number of angstrom, not {}", margin));
  const Box box = grown(bounds, margin);
  Grid grid;
  grid.spacing = spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = cells_along(box, spacing, axis);
    if (!(cells < max_cells_along_axis))
      throw std::invalid_argument(
          formatted("a spacing of {} angstrom needs {:.3g} grid points along {}; "
                    "the limit is {:g}; {}",
                    spacing, cells, "xyz"[axis], max_cells_along_axis,
                    spacing_advice(bounds, spacing, margin)));
    grid.size[axis] = static_cast<std::int64_t>(cells) + 1;
    grid.origin[axis] = box.low[axis];
  }
  const double points = points_in(box, spacing);
  if (points > max_point_count)
    throw std::invalid_argument(
        formatted("a spacing of {} angstrom needs {:.3g} grid points; the limit is {:g}; {}",
                  spacing, points, max_point_count, spacing_advice(bounds, spacing, margin)));
  return grid;
}

void require_valid(const Grid& grid) {
  if (!(grid.spacing > 0) || !std::isfinite(grid.spacing))
    throw std::invalid_argument(formatted(
        "the spacing of a grid must be a positive number of angstrom, not {}", grid.spacing));
  if (grid.spacing < min_spacing)
    throw HintedArgument(formatted("the spacing of a grid must be at least {} angstrom, not {}",
                                   min_spacing, grid.spacing),
                         {"spacing"});
  double points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto size = static_cast<double>(grid.size[axis]);
    if (size < 1 || size > max_cells_along_axis)
      throw HintedArgument(formatted("a grid has {} points along {}; it must have 1 to {:g}",
                                     grid.size[axis], "xyz"[axis], max_cells_along_axis),
                           {"grid_points"});
    if (!std::isfinite(grid.origin[axis]) || !std::isfinite(grid.upper()[axis]))
      throw std::invalid_argument(
          formatted("a grid goes from {} to {} along {}; its bounds must be finite",
                    grid.origin[axis], grid.upper()[axis], "xyz"[axis]));
    points *= size;
  }
  if (points > max_point_count)
    throw HintedArgument(
        formatted("a grid has {:.3g} points; the limit is {:g}", points, max_point_count),
        {"grid_points"});
}

void require_chosen(const Grid& grid) {
  require_valid(grid);
  // Positions on edges are distinguished to a millionth of the spacing, see tolerance::edge_end.
  constexpr double max_cells_from_zero = 1e9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (grid.size[axis] < 2)
      throw std::invalid_argument(
          formatted("the number of grid points along {} is {}; it must be 2 or more", "xyz"[axis],
                    grid.size[axis]));
    const double farthest = std::max(std::fabs(grid.origin[axis]), std::fabs(grid.upper()[axis]));
    if (farthest > max_cells_from_zero * grid.spacing)
      throw HintedArgument(
          formatted("the grid goes from {} to {} along {}, too far from 0 for a spacing of {}; the "
                    "limit is {:g} times the spacing",
                    grid.origin[axis], grid.upper()[axis], "xyz"[axis], grid.spacing,
                    max_cells_from_zero),
          {"grid_origin", "grid_center", "spacing"});
  }
}

void require_within(const GridRegion& region, const Grid& grid) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (region.begin[axis] < 0 || region.begin[axis] >= region.end[axis] ||
        region.end[axis] > grid.size[axis])
      throw std::invalid_argument(
          formatted("the region of points {} to {} along {} is not within the {} points "
                    "of the grid; its end must be above its begin",
                    region.begin[axis], region.end[axis], "xyz"[axis], grid.size[axis]));
}

GridRegion points_between(const Grid& grid, Vec3 low, Vec3 high) {
  GridRegion region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(low[axis]) || !std::isfinite(high[axis]))
      throw std::invalid_argument(
          formatted("the region goes from {} to {} along {}; its bounds must be finite", low[axis],
                    high[axis], "xyz"[axis]));
    const auto size = grid.size[axis];
    // The quotient gives an approximate index. The coordinates near it decide.
    const auto near = [&](double coordinate) {
      const double position = (coordinate - grid.origin[axis]) / grid.spacing;
      return static_cast<std::int64_t>(std::clamp(position, -2.0, static_cast<double>(size) + 1));
    };
    std::int64_t begin = std::clamp<std::int64_t>(near(low[axis]) - 2, 0, size);
    while (begin < size && grid.coordinate(axis, begin) < low[axis]) ++begin;
    std::int64_t end = std::clamp<std::int64_t>(near(high[axis]) + 3, 0, size);
    while (end > 0 && grid.coordinate(axis, end - 1) > high[axis]) --end;
    if (!(begin < end))
      throw HintedArgument(
          formatted("the region from {} to {} along {} holds no point of the grid, whose "
                    "{} points go from {} to {}",
                    low[axis], high[axis], "xyz"[axis], size, grid.origin[axis],
                    grid.upper()[axis]),
          {"region"});
    region.begin[axis] = begin;
    region.end[axis] = end;
  }
  return region;
}

std::array<double, 6> depths_inside(const Grid& grid, const Box& bounds) {
  const Vec3 lower = grid.origin, upper = grid.upper();
  std::array<double, 6> depths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double largest = std::max({std::fabs(lower[axis]), std::fabs(upper[axis]),
                                     std::fabs(bounds.low[axis]), std::fabs(bounds.high[axis])});
    const auto rounded = [&](double depth) {
      return std::fabs(depth) <= face_rounding * largest ? 0 : depth;
    };
    depths[2 * axis] = rounded(lower[axis] - bounds.low[axis]);
    depths[2 * axis + 1] = rounded(bounds.high[axis] - upper[axis]);
  }
  return depths;
}

}  // namespace eses::detail

namespace eses {

Grid centered_grid(Vec3 center, double spacing, const GridIndex& size) {
  Grid grid{center, spacing, size};
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.origin[axis] -= 0.5 * static_cast<double>(size[axis] - 1) * spacing;
  return grid;
}

}  // namespace eses
