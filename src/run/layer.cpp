#include "run/layer.hpp"

#include <bit>

#include "system/relaxed_reference.hpp"

namespace eses::detail {

BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y) {
  const std::int64_t by = block_along(tiling, 1, y);
  return {by, y - by * (tiling.block_size[1] - 1)};
}

void LayerBits::reset(const BlockTiling& tiling, std::int64_t planes) {
  const GridIndex size = tiling.region_with_halo.size();
  rows_ = size[1];
  row_words_ = static_cast<std::size_t>((size[0] + 63) / 64);
  words_.assign(static_cast<std::size_t>(rows_ * planes) * row_words_, 0);
}

// Words at the borders of blocks have bits of several blocks.
void LayerBits::add(const BlockTiling& tiling, const BlockBounds& block, const PointBits& bits) {
  if (bits.words.empty()) return;
  const auto set = [](std::uint64_t& word, std::uint64_t more) {
    if (more != 0) RelaxedReference(word).set_bits(more);
  };
  GridIndex owned = block.owned;
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (block.first[axis] + owned[axis] == tiling.region.end[axis])
      owned[axis] = tiling.region_with_halo.end[axis] - block.first[axis];
  const std::int64_t first_y = block.first[1] - tiling.region.begin[1];
  for (std::int64_t column = 0; column < bits.columns; ++column) {
    const std::int64_t x =
        block.first[0] - tiling.region.begin[0] + column * PointBits::column_step;
    const std::uint64_t mask = low_bits(bits.owned_in_column(column, owned[0]));
    const auto word = static_cast<std::size_t>(x / 64);
    const int shift = static_cast<int>(x % 64);
    for (std::int64_t z = 0; z < bits.size[2]; ++z)
      for (std::int64_t y = 0; y < owned[1]; ++y) {
        const std::uint64_t points = bits.words[bits.word_index(column, y, z)] & mask;
        if (points == 0) continue;
        std::uint64_t* const row =
            &words_[static_cast<std::size_t>(z * rows_ + first_y + y) * row_words_ + word];
        set(row[0], points << shift);
        if (shift > 0 && points >> (64 - shift) != 0) set(row[1], points >> (64 - shift));
      }
  }
}

LayerCrossings::LayerCrossings(const BlockTiling& tiling, const Layer& layer, Extent extent)
    : tiling_(tiling), extent_(extent), blocks_(static_cast<std::size_t>(tiling.blocks[1])) {
  for (std::size_t b = 0; b < layer.blocks.size(); ++b)
    if (!layer.blocks[b].crossings.empty() || !layer.blocks[b].halo_crossings.empty())
      blocks_[b / static_cast<std::size_t>(tiling.blocks[0])].push_back(&layer.blocks[b]);
}

// At the end of the grid, the points themselves replace their missing neighbours.
RegionTotals count_points(const BlockTiling& tiling, LayerBits::Row below, const Layer& layer,
                          const RowRange& rows) {
  const LayerBits& points = layer.inside;
  const GridIndex size = tiling.region.size();
  const std::int64_t rows_y = tiling.region_with_halo.size()[1];
  const bool ends_grid = tiling.region.end[0] == tiling.grid_size[0];
  RegionTotals counts;
  rows.for_each(size[1], [&](std::int64_t y, std::int64_t z) {
    const LayerBits::Row row = points.row(y, z);
    const LayerBits::Row previous = y > 0 ? points.row(y - 1, z) : row;
    const LayerBits::Row next = y + 1 < rows_y ? points.row(y + 1, z) : row;
    const LayerBits::Row lower =
        z > 0           ? points.row(y, z - 1)
        : below.empty() ? row
                        : below.subspan(static_cast<std::size_t>(y) * row.size(), row.size());
    const bool is_highest = layer.first_z() + z + 1 == tiling.grid_size[2];
    const LayerBits::Row upper = is_highest ? row : points.row(y, z + 1);
    std::int64_t owned = size[0];
    for (std::size_t w = 0; owned > 0; ++w, owned -= 64) {
      const std::uint64_t bits = row[w];
      const std::uint64_t end =
          ends_grid && owned <= 64 ? bits & std::uint64_t{1} << (owned - 1) : 0;
      const std::uint64_t left = bits << 1 | (w > 0 ? row[w - 1] >> 63 : bits & 1);
      const std::uint64_t right = bits >> 1 | (w + 1 < row.size() ? row[w + 1] << 63 : 0) | end;
      const std::uint64_t differ = (bits ^ left) | (bits ^ right) | (bits ^ previous[w]) |
                                   (bits ^ next[w]) | (bits ^ lower[w]) | (bits ^ upper[w]);
      const std::uint64_t inside = bits & low_bits(owned), irregular = differ & low_bits(owned);
      if ((inside | irregular) == 0) continue;
      counts.inside_points += std::popcount(inside);
      counts.inside_regular += std::popcount(inside & ~irregular);
      counts.irregular_points += std::popcount(irregular);
    }
  });
  return counts;
}

}  // namespace eses::detail
