#pragma once
/// Solved blocks, and layers of them as rows of the whole grid. Threads take the rows in batches.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/tiling.hpp"
#include "solve/block_solver.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// Returns whether a point of the block is inside the surface. Blocks of a Layer have lost their
/// points to it.
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

/// A bit for each point of the rows of a layer, with the halo.
class LayerBits {
 public:
  /// The words of a row: bit i % 64 of word i / 64 is point i.
  using Row = std::span<const std::uint64_t>;

  /// Clears the bits of this number of planes.
  void reset(const BlockTiling& tiling, std::int64_t planes);
  /// Removes all planes. Their memory is kept for the next layer: threads that freed and took such
  /// large pieces in turn would each keep some.
  void clear() { words_.clear(); }
  bool is_empty() const { return words_.empty(); }
  /// Sets the bits of a block, which owns them or has them in the halo of the region. Several
  /// threads may call it for different blocks.
  void add(const BlockTiling& tiling, const BlockBounds& block, const PointBits& bits);

  /// Row (y, z). `y` is relative to the region's first row, `z` to the layer's first plane.
  Row row(std::int64_t y, std::int64_t z) const {
    return Row(words_).subspan(static_cast<std::size_t>(z * rows_ + y) * row_words_, row_words_);
  }
  /// The rows of a plane, by y.
  Row plane(std::int64_t z) const {
    const std::size_t size = static_cast<std::size_t>(rows_) * row_words_;
    return Row(words_).subspan(static_cast<std::size_t>(z) * size, size);
  }

 private:
  std::int64_t rows_ = 0;  // of a plane
  std::size_t row_words_ = 0;
  std::vector<std::uint64_t> words_;  // [z][y][x]
};

/// The results of a layer of blocks.
struct Layer {
  std::vector<BlockResult> blocks;  ///< [by][bx], without their points, which `inside` has
  LayerBits inside;
  LayerBits covered;  ///< see BlockResult; empty unless it is needed

  std::int64_t first_z() const { return blocks.front().block.first[2]; }
  std::int64_t owned_planes() const { return blocks.front().block.owned[2]; }
};

/// The crossings of rows: of the region, or of BlockTiling::region_with_halo.
enum class Extent { region, with_halo };

/// Returns the index along an axis of the block that owns a point. `offset` is relative to the
/// region's first point.
inline std::int64_t block_along(const BlockTiling& tiling, std::size_t axis, std::int64_t offset) {
  return std::min(offset / (tiling.block_size[axis] - 1), tiling.blocks[axis] - 1);
}

/// The position of a row in its blocks: the index `by` of the blocks along y, and the local index
/// `y` of the row in these blocks.
struct BlockRow {
  std::int64_t by = 0, y = 0;
};

/// Returns the position of row `y`, relative to the region's first row.
BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y);

/// An index of the blocks with crossings in a layer, made once for many rows.
class LayerCrossings {
 public:
  /// With the halo, rows have the crossings of the halo as well, and there are further rows.
  LayerCrossings(const BlockTiling& tiling, const Layer& layer, Extent extent = Extent::region);

  /// Calls `action(first_x, crossings)` for the parts of row (y, z), in the order of x. The `x` of
  /// a crossing is relative to `first_x`. `y` is relative to the region's first row, `z` to the
  /// layer's first plane.
  template <class Action>
  void for_each_row_part(std::int64_t y, std::int64_t z, Action&& action) const {
    const BlockRow row = block_row_of(tiling_, y);
    for (const BlockResult* const result : blocks_[static_cast<std::size_t>(row.by)]) {
      const auto act_on = [&](std::span<const BlockCrossing> part) {
        if (!part.empty()) action(result->block.first[0], part);
      };
      const auto& [first, points, owned] = result->block;
      if (row.y < owned[1] && z < owned[2])
        act_on(row_crossings(result->crossings, result->row_begin, z * owned[1] + row.y));
      if (extent_ == Extent::with_halo)
        act_on(
            row_crossings(result->halo_crossings, result->halo_row_begin, z * points[1] + row.y));
    }
  }

 private:
  const BlockTiling& tiling_;
  Extent extent_;
  std::vector<std::vector<const BlockResult*>> blocks_;  // by block row
};

/// Counts the points of these rows of a layer, and nothing else. `below` has the inside bits of the
/// last plane of the previous layer, and is empty if there is none.
RegionTotals count_points(const BlockTiling& tiling, LayerBits::Row below, const Layer& layer,
                          const RowRange& rows);

}  // namespace eses::detail
