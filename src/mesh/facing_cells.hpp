#pragma once
/// The directions that the triangles in a part of space face.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/grid.hpp"
#include "mesh/triangle_shape.hpp"

namespace eses::detail::mesh {

/// A set of 14 directions: those of the axes and of the diagonals of a cube.
using Directions = std::uint16_t;
inline constexpr Directions all_directions = (1U << 14U) - 1;

/// Returns the directions that a triangle does not face, as they form an angle of at least 90
/// degrees with its normal, or of so little less that rounding errors decide.
inline Directions directions_not_faced(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto [x, y, z] = area_vector(a, b, c);
  const double sum = x + y, difference = x - y, error = area_error(a, b, c);
  const std::array<double, 7> along{x, y, z, sum + z, sum - z, difference + z, difference - z};
  constexpr unsigned axes = (1U << along.size()) - 1;
  unsigned negative = 0;
  double least = std::fabs(along[0]);
  for (std::size_t i = 0; i < along.size(); ++i) {
    negative |= static_cast<unsigned>(std::signbit(along[i])) << i;
    least = std::min(least, std::fabs(along[i]));
  }
  // A triangle faces one of two opposite directions, unless rounding errors may decide.
  unsigned neither = 0;
  if (least <= error)
    for (std::size_t i = 0; i < along.size(); ++i)
      neither |= static_cast<unsigned>(std::fabs(along[i]) <= error) << i;
  const unsigned positive = ~negative & axes;
  return static_cast<Directions>(negative | neither | (positive | neither) << along.size());
}

/// The directions that triangles do not face, by cubic cells of two spacings. Cells that are far
/// below the highest triangle are forgotten. Triangles are never removed.
class FacingCells {
 public:
  /// Planes of the grid, below the highest triangle, whose cells are kept.
  static constexpr std::int64_t kept_planes = 28;

  FacingCells(const Grid& grid, const GridRegion& region)
      : origin_(grid.point(region.begin)),
        inset_(0.501 * grid.spacing),
        scale_(0.5 / grid.spacing) {
    for (std::size_t axis = 0; axis < 2; ++axis) size_[axis] = cells_along(region.size()[axis]);
    cells_.resize(static_cast<std::size_t>(size_[0] * size_[1] * ring_size));
  }

  /// Returns the memory in bytes.
  static double memory_bytes(const GridRegion& region) {
    return static_cast<double>(cells_along(region.size()[0])) *
           static_cast<double>(cells_along(region.size()[1])) * ring_size * sizeof(Directions);
  }

  /// Adds triangles in a box and the directions that some of them do not face.
  void add(Bounds box, Directions directions) {
    // Another box that overlaps this one comes within `inset_` of the reduced box along each axis.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double &low = box.low[axis], &high = box.high[axis];
      const double middle = (low + high) / 2;
      low = std::min(low + inset_, middle);
      high = std::max(high - inset_, middle);
    }
    const CellBox cells = cells_in(box);
    clear_up_to(cells.high[2]);
    for_each_row(cells, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) cells_[static_cast<std::size_t>(i)] |= directions;
    });
  }

  /// Adds a triangle in a cell of the grid.
  void add_small(const Vec3& a, const Vec3& b, const Vec3& c) {
    // The middle of the triangle is in the same cell of the grid, and cells have whole cells of it.
    const Vec3 middle = (1.0 / 3) * (a + b + c);
    const std::int64_t z = cell_of(middle, 2);
    clear_up_to(z);
    cells_[static_cast<std::size_t>(cell_at(cell_of(middle, 0), cell_of(middle, 1), z))] |=
        directions_not_faced(a, b, c);
  }

  /// Returns the directions that some triangle does not face, among all triangles that overlap a
  /// box and some triangles nearby.
  Directions within(Bounds box) const {
    const Vec3 inset{inset_, inset_, inset_};
    box.low = box.low - inset;
    box.high = box.high + inset;
    Directions result = 0;
    CellBox cells = cells_in(box);
    cells.high[2] = std::min(cells.high[2], top_);
    for_each_row(cells, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) result |= cells_[static_cast<std::size_t>(i)];
    });
    return result;
  }

 private:
  static constexpr std::int64_t ring_size = 16;  // planes of cells, a power of two
  static_assert(2 * (ring_size - 2) >= kept_planes);

  struct CellBox {
    GridIndex low, high;
  };

  static std::int64_t cells_along(std::int64_t points) { return points / 2 + 1; }
  std::int64_t cell_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return ((z & (ring_size - 1)) * size_[1] + y) * size_[0] + x;
  }

  // Points beyond the region belong to the cells at its border.
  std::int64_t cell_of(const Vec3& point, std::size_t axis) const {
    const double cells = std::max(0.0, (point[axis] - origin_[axis]) * scale_);
    const auto cell = static_cast<std::int64_t>(cells);
    return axis < 2 ? std::min(cell, size_[axis] - 1) : cell;
  }
  CellBox cells_in(const Bounds& box) const {
    CellBox cells;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cells.low[axis] = cell_of(box.low, axis);
      cells.high[axis] = cell_of(box.high, axis);
    }
    return cells;
  }

  void clear_up_to(std::int64_t z) {
    while (top_ < z) {
      ++top_;
      std::fill_n(cells_.begin() + cell_at(0, 0, top_), size_[0] * size_[1], Directions{0});
    }
  }

  // Calls f(begin, end) for the indices of each row of cells.
  template <class Function>
  void for_each_row(const CellBox& box, const Function& f) const {
    for (std::int64_t z = box.low[2]; z <= box.high[2]; ++z)
      for (std::int64_t y = box.low[1]; y <= box.high[1]; ++y)
        f(cell_at(box.low[0], y, z), cell_at(box.high[0], y, z) + 1);
  }

  Vec3 origin_;
  double inset_;                        // half of a spacing, and some room for rounding
  double scale_;                        // cells in an angstrom
  std::array<std::int64_t, 2> size_{};  // cells along x and y
  std::int64_t top_ = -1;               // highest plane of cells that has been used
  std::vector<Directions> cells_;
};

}  // namespace eses::detail::mesh
