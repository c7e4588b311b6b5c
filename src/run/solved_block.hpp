#pragma once
/// Points and crossings of a solved block, by their indices in the grid.

#include <cstdint>
#include <span>

#include "solve/block_solver.hpp"

namespace eses::detail {

/// Returns whether a point of the block is inside the surface.
inline bool is_inside(const BlockResult& block, const GridIndex& point) {
  const GridIndex& first = block.block.first;
  return block.inside.test({point[0] - first[0], point[1] - first[1], point[2] - first[2]});
}

/// Returns the crossings of a row. `row_begin` has the begin of each row, and is empty if there are
/// no crossings.
inline std::span<const BlockCrossing> row_crossings(std::span<const BlockCrossing> crossings,
                                                    std::span<const std::uint32_t> row_begin,
                                                    std::int64_t row) {
  if (row_begin.empty()) return {};
  const auto r = static_cast<std::size_t>(row);
  return crossings.subspan(row_begin[r], row_begin[r + 1] - row_begin[r]);
}

/// Calls `action(row_start, crossing)` for the crossings of all edges that the block owns, by lower
/// point (z, y, x), then axis. The lower point of a crossing is `crossing.x` points from
/// `row_start` along x.
template <class Action>
void for_each_crossing(const BlockResult& result, Action&& action) {
  if (result.crossings.empty()) return;
  const auto& [first, points, owned] = result.block;
  for (std::int64_t row = 0; row < owned[1] * owned[2]; ++row) {
    const GridIndex row_start{first[0], first[1] + row % owned[1], first[2] + row / owned[1]};
    for (const BlockCrossing& crossing : row_crossings(result.crossings, result.row_begin, row))
      action(row_start, crossing);
  }
}

/// Calls `action(crossing)` for the same crossings, converted by to_crossing().
template <class Action>
void for_each_crossing(const Grid& grid, const BlockResult& result, Action&& action) {
  for_each_crossing(result, [&](const GridIndex& row_start, const BlockCrossing& crossing) {
    action(to_crossing(grid, row_start, crossing));
  });
}

}  // namespace eses::detail
