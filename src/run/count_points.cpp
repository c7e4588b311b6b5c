#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "run/count_points.cpp"
#include "run/count_points.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <vector>

#include "grid/point_bits.hpp"
#include "system/dispatch.hpp"

// This file is compiled for each instruction set, as the baseline has no instruction to count bits.
HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// The words of one column of points in one plane, by y, and the words of their neighbours. At the
// end of the grid, the words of the points themselves replace the words of missing neighbours.
struct ColumnPlane {
  const std::uint64_t* words;
  const std::uint64_t* below;  // z - 1
  const std::uint64_t* above;  // z + 1
  const std::uint64_t* left;   // the previous column; null at the start of the rows
  std::uint64_t before_first;  // the word at y - 1 of the first word
  bool continues_in_y;         // whether there is a word after the last one to be counted
  std::int64_t left_bit;       // bit of the point before the first one in `left`
  std::uint64_t owned;         // bits to count
  std::uint64_t row_end;       // the last bit of the rows if it is in this column, else 0
};

void count(const ColumnPlane& column, std::int64_t rows, PointCounts& counts) {
  for (std::int64_t y = 0; y < rows; ++y) {
    const std::uint64_t bits = column.words[y];
    const std::uint64_t next = y + 1 < rows || column.continues_in_y ? column.words[y + 1] : bits;
    const std::uint64_t previous = y > 0 ? column.words[y - 1] : column.before_first;
    const std::uint64_t first_left =
        column.left != nullptr ? column.left[y] >> column.left_bit & 1 : bits & 1;
    const std::uint64_t left = bits << 1 | first_left;
    const std::uint64_t right = bits >> 1 | (bits & column.row_end);
    const std::uint64_t differ = (bits ^ left) | (bits ^ right) | (bits ^ previous) |
                                 (bits ^ next) | (bits ^ column.below[y]) |
                                 (bits ^ column.above[y]);
    const std::uint64_t irregular = differ & column.owned;
    counts.inside += std::popcount(bits & column.owned);
    counts.inside_regular += std::popcount(bits & column.owned & ~irregular);
    counts.irregular += std::popcount(irregular);
  }
}

// The columns of a layer, including the columns of empty blocks.
class LayerColumns {
 public:
  LayerColumns(const BlockTiling& tiling, const Plane& below, const Layer& layer)
      : tiling_(tiling),
        below_(below),
        layer_(layer),
        nothing_inside_(static_cast<std::size_t>(layer.blocks.front().block.points[1])) {}

  void count_block(std::int64_t bx, std::int64_t by, PointCounts& counts) const {
    const BlockResult& result = block(bx, by);
    for (std::int64_t c = 0; c < result.inside.columns; ++c)
      for (std::int64_t z = 0; z < result.block.owned[2]; ++z)
        count(column(bx, by, c, z), result.block.owned[1], counts);
  }

 private:
  const BlockResult& block(std::int64_t bx, std::int64_t by) const {
    return layer_.blocks[static_cast<std::size_t>(by * tiling_.blocks[0] + bx)];
  }

  // Returns the words of plane z of a column; -1 is the plane below the layer.
  const std::uint64_t* words(std::int64_t bx, std::int64_t by, std::int64_t c,
                             std::int64_t z) const {
    const PointBits& inside = block(bx, by).inside;
    if (z < 0) {
      const auto& plane = below_.blocks[static_cast<std::size_t>(by * tiling_.blocks[0] + bx)];
      return plane.empty() ? nothing_inside_.data() : plane.data() + c * inside.size[1];
    }
    if (inside.words.empty()) return nothing_inside_.data();
    return inside.words.data() + inside.word_index(c, 0, z);
  }

  ColumnPlane column(std::int64_t bx, std::int64_t by, std::int64_t c, std::int64_t z) const {
    const BlockResult& result = block(bx, by);
    const PointBits& inside = result.inside;
    const bool is_lowest = z == 0 && below_.blocks.empty();
    const bool is_highest = layer_.first_z() + z == tiling_.grid_size[2] - 1;
    ColumnPlane column{};
    column.words = words(bx, by, c, z);
    column.below = is_lowest ? column.words : words(bx, by, c, z - 1);
    column.above = is_highest ? column.words : words(bx, by, c, z + 1);
    column.before_first =
        by > 0 ? words(bx, by - 1, c, z)[block(bx, by - 1).block.owned[1] - 1] : column.words[0];
    column.continues_in_y = result.block.owned[1] < inside.size[1];
    const std::int64_t owned = inside.owned_in_column(c, result.block.owned[0]);
    column.owned = low_bits(owned);
    // The rows end with this block, unless the block has the next point, in the halo of the region.
    const bool ends_rows = bx + 1 == tiling_.blocks[0] && c + 1 == inside.columns &&
                           result.block.owned[0] == result.block.points[0];
    column.row_end = ends_rows ? std::uint64_t{1} << (owned - 1) : 0;
    if (c > 0) {
      column.left = words(bx, by, c - 1, z);
      column.left_bit = PointBits::column_step - 1;
    } else if (bx > 0) {
      const BlockResult& before = block(bx - 1, by);
      const std::int64_t last = before.inside.columns - 1;
      column.left = words(bx - 1, by, last, z);
      column.left_bit = before.inside.owned_in_column(last, before.block.owned[0]) - 1;
    }
    return column;
  }

  const BlockTiling& tiling_;
  const Plane& below_;
  const Layer& layer_;
  std::vector<std::uint64_t> nothing_inside_;
};

void count_blocks(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                  std::int64_t begin, std::int64_t end, PointCounts& counts) {
  const LayerColumns columns(tiling, below, layer);
  for (std::int64_t b = begin; b < end; ++b)
    columns.count_block(b % tiling.blocks[0], b / tiling.blocks[0], counts);
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {

PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         std::int64_t begin, std::int64_t end) {
  PointCounts counts;
  ESES_BEST_VERSION(count_blocks)(tiling, below, layer, begin, end, counts);
  return counts;
}

}  // namespace eses::detail
#endif  // HWY_ONCE
