#pragma once
/// Division of a layer's rows into batches, which threads format as text.

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

/// The batches of the layers of a region. With `ends_with_planes`, they are also cut at the end of
/// each plane, so that they do not depend on the height of layers, and so not on the block size.
class RowBatches {
 public:
  RowBatches(const GridRegion& region, bool ends_with_planes)
      : plane_rows_(region.size()[1]),
        rows_per_batch_(rows_per_batch(region.size()[0])),
        ends_with_planes_(ends_with_planes) {}

  std::int64_t count(std::int64_t planes) const {
    return ends_with_planes_ ? planes * batches_in(plane_rows_) : batches_in(planes * plane_rows_);
  }

  RowRange rows(std::int64_t batch, std::int64_t planes) const {
    const std::int64_t per_plane = batches_in(plane_rows_);
    const std::int64_t plane = ends_with_planes_ ? batch / per_plane : 0;
    const std::int64_t begin = plane * plane_rows_ + (batch - plane * per_plane) * rows_per_batch_;
    const std::int64_t last = ends_with_planes_ ? plane + 1 : planes;
    return {begin, std::min(begin + rows_per_batch_, last * plane_rows_)};
  }

 private:
  std::int64_t batches_in(std::int64_t rows) const {
    return (rows + rows_per_batch_ - 1) / rows_per_batch_;
  }

  std::int64_t plane_rows_, rows_per_batch_;
  bool ends_with_planes_;
};

}  // namespace eses::detail
