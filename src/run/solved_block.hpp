#pragma once
/// A solved block as callbacks receive it.

#include <cstdint>
#include <span>

#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"
#include "grid/tiling.hpp"

namespace eses::detail {

struct BlockResult;

/// A view of the result of a block, which is valid during the callback.
class SolvedBlock {
 public:
  explicit SolvedBlock(const BlockResult& result) : result_(&result) {}

  const BlockBounds& block() const;

  /// Returns whether a point of the block is inside the surface. `point` has indices in the grid.
  bool is_inside(const GridIndex& point) const;

  /// Sets the elements of `row` that correspond to inside points to 1. The row has the grid indices
  /// `y` and `z`, and starts with the block's first point. All elements must be 0.
  void mark_inside(std::int64_t y, std::int64_t z, std::span<std::uint8_t> row) const;

  /// The crossings of all edges that the block owns, by lower point (z, y, x), then axis.
  /// `BlockCrossing::x` is relative to the block's first point.
  std::span<const BlockCrossing> crossings() const;

  /// The crossings of the edges that start in an owned row with the grid indices `y` and `z`.
  std::span<const BlockCrossing> crossings_of_row(std::int64_t y, std::int64_t z) const;

  /// The time to solve the block on one processor, in seconds.
  double seconds() const;

 private:
  const BlockResult* result_;
};

}  // namespace eses::detail
