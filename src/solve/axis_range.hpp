#pragma once
/// Ranges of a block's points and edges within intervals of space.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "geometry/point_bits.hpp"
#include "solve/block_features.hpp"

namespace eses::detail {

/// Indices [begin, end) along one axis, relative to the block's first point.
struct AxisRange {
  std::int64_t begin, end;
};

/// A range includes points that are at most this far beyond its bounds, in spacings. The value is
/// far above rounding errors.
inline constexpr double range_slack = 1e-6;

/// Returns the block's points between `low` and `high` (angstrom).
inline AxisRange points_within(const BlockGrid& grid, std::size_t axis, double low, double high) {
  const double inverse = grid.inverse_spacing;
  const auto first = static_cast<double>(grid.block.first[axis]);
  const auto points = static_cast<double>(grid.block.points[axis]);
  const double a = std::ceil((low - grid.grid.origin[axis]) * inverse - range_slack) - first;
  const double b = std::floor((high - grid.grid.origin[axis]) * inverse + range_slack) - first + 1;
  return {static_cast<std::int64_t>(std::clamp(a, 0.0, points)),
          static_cast<std::int64_t>(std::clamp(b, 0.0, points))};
}

/// Returns the points that the block owns between `low` and `high` (angstrom).
inline AxisRange own_points_within(const BlockGrid& grid, std::size_t axis, double low,
                                   double high) {
  const AxisRange range = points_within(grid, axis, low, high);
  return {range.begin, std::min(range.end, grid.block.owned[axis])};
}

/// Returns the lower points of the edges along `axis` that the block owns and that meet the
/// interval.
inline AxisRange own_edges_within(const BlockGrid& grid, std::size_t axis, double low,
                                  double high) {
  return own_points_within(grid, axis, low - grid.grid.spacing, high);
}

/// Returns the columns of PointBits that contain these points.
inline AxisRange columns_of(const AxisRange& x, std::int64_t columns) {
  if (x.begin >= x.end) return {0, 0};
  // A point that two columns share also belongs to the previous one.
  return {std::max<std::int64_t>(0, (x.begin - 1) / PointBits::column_step),
          std::min(columns, (x.end - 1) / PointBits::column_step + 1)};
}

/// Returns the bits of these points in a column.
inline std::uint64_t column_bits(const AxisRange& x, std::int64_t column) {
  const std::int64_t first = column * PointBits::column_step;
  return low_bits(std::clamp<std::int64_t>(x.end - first, 0, PointBits::column_points)) &
         ~low_bits(std::clamp<std::int64_t>(x.begin - first, 0, PointBits::column_points));
}

/// The position of a word of PointBits.
struct WordPosition {
  std::int64_t column = 0, y = 0, z = 0;
  std::size_t word = 0;
};

/// Calls `action(word, bits)` for each of `words` that has set bits within the ranges along x, y
/// and z. `bits` are these bits. `words` have the same layout as those of `layout`.
template <class Action>
void for_each_word(const PointBits& layout, std::span<const std::uint64_t> words,
                   const std::array<AxisRange, 3>& range, Action&& action) {
  const AxisRange columns = columns_of(range[0], layout.columns);
  for (std::int64_t column = columns.begin; column < columns.end; ++column) {
    const std::uint64_t within = column_bits(range[0], column);
    for (std::int64_t z = range[2].begin; z < range[2].end; ++z)
      for (std::int64_t y = range[1].begin; y < range[1].end; ++y) {
        const std::size_t word = layout.word_index(column, y, z);
        if (const std::uint64_t bits = words[word] & within; bits != 0)
          action(WordPosition{column, y, z, word}, bits);
      }
  }
}

}  // namespace eses::detail
