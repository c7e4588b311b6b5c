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

/// A set of the 26 directions (x, y, z) with components -1, 0 and 1.
using Directions = std::uint32_t;
inline constexpr Directions all_directions = (Directions{1} << 26U) - 1;

/// Returns the directions that a triangle does not face, as they form an angle of at least 90
/// degrees with its normal. `area` is the area vector of the triangle.
inline Directions directions_not_faced(const Vec3& area) {
  const auto [x, y, z] = area;
  const std::array<double, 13> along{x,     y,     z,         x + y,     x - y,     x + z,    x - z,
                                     y + z, y - z, x + y + z, x + y - z, x - y + z, x - y - z};
  Directions result = 0;
  for (std::size_t i = 0; i < along.size(); ++i) {
    result |= static_cast<Directions>(along[i] <= 0) << i;
    result |= static_cast<Directions>(along[i] >= 0) << (i + along.size());
  }
  return result;
}

/// The directions that triangles do not face, by cubic cells of two spacings. Cells that are far
/// below the highest triangle are forgotten. Triangles are never removed.
class FacingCells {
 public:
  /// Planes of the grid, below the highest triangle, whose cells are kept.
  static constexpr std::int64_t kept_planes = 28;

  FacingCells(const Grid& grid, const GridRegion& region)
      : origin_(grid.point(region.begin)), inset_(0.5 * grid.spacing), scale_(0.5 / grid.spacing) {
    for (std::size_t axis = 0; axis < 2; ++axis) size_[axis] = cells_along(region.size()[axis]);
    cells_.resize(static_cast<std::size_t>(size_[0] * size_[1] * ring_size));
  }

  /// Returns the memory in bytes.
  static double memory_bytes(const GridRegion& region) {
    return static_cast<double>(cells_along(region.size()[0])) *
           static_cast<double>(cells_along(region.size()[1])) * ring_size * sizeof(Directions);
  }

  /// Adds a triangle and the directions that it does not face.
  void add(const TrianglePoints& t, Directions directions) {
    // A box that overlaps the triangle comes within `inset_` of the reduced bounds along each axis.
    Bounds bounds(t);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double &low = bounds.low[axis], &high = bounds.high[axis];
      const double middle = (low + high) / 2;
      low = std::min(low + inset_, middle);
      high = std::max(high - inset_, middle);
    }
    const CellBox box = cells_in(bounds);
    while (top_ < box.high[2]) {
      ++top_;
      std::fill_n(cells_.begin() + cell_at(0, 0, top_), size_[0] * size_[1], 0);
    }
    for_each_row(box, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) cells_[static_cast<std::size_t>(i)] |= directions;
    });
  }

  /// Returns the directions that some triangle does not face, among all triangles that overlap a
  /// box and some triangles nearby.
  Directions within(Bounds bounds) const {
    const Vec3 inset{inset_, inset_, inset_};
    bounds.low = bounds.low - inset;
    bounds.high = bounds.high + inset;
    Directions result = 0;
    CellBox box = cells_in(bounds);
    box.high[2] = std::min(box.high[2], top_);
    for_each_row(box, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) result |= cells_[static_cast<std::size_t>(i)];
    });
    return result;
  }

 private:
  static constexpr std::int64_t ring_size = 16;  // planes of cells
  static_assert(2 * (ring_size - 2) >= kept_planes);

  struct CellBox {
    GridIndex low, high;
  };

  static std::int64_t cells_along(std::int64_t points) { return points / 2 + 1; }
  std::int64_t cell_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return (z % ring_size * size_[1] + y) * size_[0] + x;
  }

  // Points beyond the region belong to the cells at its border.
  CellBox cells_in(const Bounds& bounds) const {
    const auto cell = [&](double coordinate, std::size_t axis) {
      const auto i = static_cast<std::int64_t>(
          std::max(0.0, (coordinate - origin_[axis]) * scale_));
      return axis < 2 ? std::min(i, size_[axis] - 1) : i;
    };
    CellBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = cell(bounds.low[axis], axis);
      box.high[axis] = cell(bounds.high[axis], axis);
    }
    return box;
  }

  // Calls f(begin, end) for the indices of each row of cells.
  template <class Function>
  void for_each_row(const CellBox& box, const Function& f) const {
    for (std::int64_t z = box.low[2]; z <= box.high[2]; ++z)
      for (std::int64_t y = box.low[1]; y <= box.high[1]; ++y)
        f(cell_at(box.low[0], y, z), cell_at(box.high[0], y, z) + 1);
  }

  Vec3 origin_;
  double inset_, scale_;
  std::array<std::int64_t, 2> size_{};  // cells along x and y
  std::int64_t top_ = -1;               // highest plane of cells that has been used
  std::vector<Directions> cells_;
};

}  // namespace eses::detail::mesh
