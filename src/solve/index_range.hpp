#pragma once
/// Which points of a block a box reaches.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "grid/point_bits.hpp"
#include "solve/block_features.hpp"

namespace eses::detail {

/// Indices [begin, end) along one axis, from the block's first point.
struct IndexRange {
  std::int64_t begin, end;
};

/// A point this near to the bound of a range, in spacings, is in it, however it is rounded.
inline constexpr double range_slack = 1e-6;

/// The points between `low` and `high`.
inline IndexRange points_within(const BlockGrid& grid, std::size_t axis, double low, double high) {
  const double inverse = grid.inverse_spacing;
  const auto first = static_cast<double>(grid.block.first[axis]);
  const auto points = static_cast<double>(grid.block.points[axis]);
  const double a = std::ceil((low - grid.grid.origin[axis]) * inverse - range_slack) - first;
  const double b = std::floor((high - grid.grid.origin[axis]) * inverse + range_slack) - first + 1;
  return {static_cast<std::int64_t>(std::clamp(a, 0.0, points)),
          static_cast<std::int64_t>(std::clamp(b, 0.0, points))};
}

/// Of those the ones that the block owns.
inline IndexRange own_points_within(const BlockGrid& grid, std::size_t axis, double low,
                                    double high) {
  const IndexRange range = points_within(grid, axis, low, high);
  return {range.begin, std::min(range.end, grid.block.owned[axis])};
}

/// The block's own points at which edges along `axis` start that reach into the interval.
inline IndexRange own_edges_within(const BlockGrid& grid, std::size_t axis, double low,
                                   double high) {
  return own_points_within(grid, axis, low - grid.grid.spacing, high);
}

/// The columns that hold these points.
inline IndexRange columns_of(const IndexRange& x, std::int64_t columns) {
  if (x.begin >= x.end) return {0, 0};
  // A shared point belongs to the column before, too.
  return {std::max<std::int64_t>(0, (x.begin - 1) / PointBits::column_step),
          std::min(columns, (x.end - 1) / PointBits::column_step + 1)};
}

/// The bits of a column that belong to these points.
inline std::uint64_t column_bits(const IndexRange& x, std::int64_t column) {
  const std::int64_t first = column * PointBits::column_step;
  return low_bits(std::clamp<std::int64_t>(x.end - first, 0, PointBits::column_points)) &
         ~low_bits(std::clamp<std::int64_t>(x.begin - first, 0, PointBits::column_points));
}

/// A word of PointBits.
struct WordPlace {
  std::int64_t column = 0, y = 0, z = 0;
  std::size_t word = 0;
};

/// Calls `action(place, bits)` for every one of `words`, which are laid out as those of `layout`,
/// with the bits that are set within the ranges along x, y and z, if there are any.
template <class Action>
void for_each_word(const PointBits& layout, std::span<const std::uint64_t> words,
                   const std::array<IndexRange, 3>& range, Action&& action) {
  const IndexRange columns = columns_of(range[0], layout.columns);
  for (std::int64_t column = columns.begin; column < columns.end; ++column) {
    const std::uint64_t within = column_bits(range[0], column);
    for (std::int64_t z = range[2].begin; z < range[2].end; ++z)
      for (std::int64_t y = range[1].begin; y < range[1].end; ++y) {
        const std::size_t word = layout.word_index(column, y, z);
        if (const std::uint64_t bits = words[word] & within; bits != 0)
          action(WordPlace{column, y, z, word}, bits);
      }
  }
}

}  // namespace eses::detail
