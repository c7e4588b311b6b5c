#pragma once
/// Division of the rows of planes into batches, which threads format as text.

#include <algorithm>
#include <cstdint>

#include "eses/grid.hpp"

namespace eses::detail {

/// Returns the number of rows that a thread formats at a time.
inline std::int64_t rows_per_batch(std::int64_t row_points) {
  constexpr std::int64_t text_bytes = 1 << 19;
  constexpr std::int64_t line_bytes = 16;
  return std::max<std::int64_t>(1, text_bytes / (line_bytes * row_points));
}

/// Rows [begin, end) of a layer.
struct RowRange {
  std::int64_t begin, end;

  /// Calls `action(y, z)` for each row of planes with `rows_y` rows.
  template <class Action>
  void for_each(std::int64_t rows_y, Action&& action) const {
    for (std::int64_t row = begin; row < end; ++row) action(row % rows_y, row / rows_y);
  }
};

/// The batches of the planes of a region. They end where planes end, so that they do not depend on
/// the height of layers, and so not on the block size.
class RowBatches {
 public:
  explicit RowBatches(const GridRegion& region)
      : plane_rows_(region.size()[1]), rows_per_batch_(rows_per_batch(region.size()[0])) {}

  std::int64_t per_plane() const { return (plane_rows_ + rows_per_batch_ - 1) / rows_per_batch_; }

  /// Returns the rows of a batch, counted from the plane of batch 0.
  RowRange rows(std::int64_t batch) const {
    const std::int64_t plane = batch / per_plane();
    const std::int64_t begin = (batch - plane * per_plane()) * rows_per_batch_;
    const std::int64_t end = std::min(begin + rows_per_batch_, plane_rows_);
    return {plane * plane_rows_ + begin, plane * plane_rows_ + end};
  }

 private:
  std::int64_t plane_rows_, rows_per_batch_;
};

}  // namespace eses::detail
