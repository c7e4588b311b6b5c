#pragma once
/// One block of the grid as it is handed out while a run goes on.

#include <cstdint>
#include <span>

#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"
#include "grid/tiling.hpp"

namespace eses::detail {

struct BlockResult;

/// A view of what was found in a block; valid while the callback that gets it runs.
class SolvedBlock {
 public:
  explicit SolvedBlock(const BlockResult& result) : result_(&result) {}

  const BlockBounds& block() const;

  /// Whether a point of the block's closed box is inside the molecule; `point` has global indices.
  bool is_inside(const GridIndex& point) const;

  /// Writes 1 for each inside point at the beginning of the row at `y` and `z`, global indices, of
  /// the closed box. All elements of `row` must be 0.
  void mark_inside(std::int64_t y, std::int64_t z, std::span<std::uint8_t> row) const;

  /// The crossings of all edges that start at points which the block owns, by lower point (z, y,
  /// x), then axis. `BlockCrossing::x` counts from the block's first point.
  std::span<const BlockCrossing> crossings() const;

  /// Those of them whose edges start in the row of points at `y` and `z`, global indices of a row
  /// that the block owns.
  std::span<const BlockCrossing> crossings_of_row(std::int64_t y, std::int64_t z) const;

  /// What it took to solve the block, on one processor.
  double seconds() const;

 private:
  const BlockResult* result_;
};

}  // namespace eses::detail
