#pragma once
/// One block of the grid as it is handed out while a run goes on.

#include <cstdint>
#include <functional>
#include <span>

#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "eses/tiling.hpp"

namespace eses {

struct BlockResult;

/// A view of what was found in a block; valid while the callback that gets it runs.
class SolvedBlock {
 public:
  explicit SolvedBlock(const BlockResult& result) : result_(&result) {}

  const Block& block() const;

  /// Whether a point of the block's closed box is inside the molecule; `point` has global indices.
  bool is_inside(const GridIndex& point) const;

  /// The crossings of all edges that start at points which the block owns, by lower point (z, y,
  /// x), then axis. `Crossing::x` counts from the block's first point.
  std::span<const Crossing> crossings() const;

  /// Those of them whose edges start in the row of points at `y` and `z`, global indices of a row
  /// that the block owns.
  std::span<const Crossing> crossings_of_row(std::int64_t y, std::int64_t z) const;

  /// What it took to solve the block, on one processor.
  double seconds() const;

 private:
  const BlockResult* result_;
};

/// Receives every block once, in no particular order. See `Callbacks` for the threads that call it.
/// An exception that it throws ends the run, which throws it on.
using BlockCallback = std::function<void(const SolvedBlock&)>;

}  // namespace eses
