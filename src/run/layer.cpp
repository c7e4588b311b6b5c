#include "run/layer.hpp"

#include <bit>

namespace eses::detail {
namespace {

// Appends the low `count` bits of `bits` after the first `position` bits of a row. The further bits
// of the row must be 0.
void append_bits(RowBits& row, std::int64_t position, std::uint64_t bits, std::int64_t count) {
  bits &= low_bits(count);
  const auto word = static_cast<std::size_t>(position / 64);
  const int shift = static_cast<int>(position % 64);
  row[word] |= bits << shift;
  if (shift + count > 64) row[word + 1] |= bits >> (64 - shift);
}

}  // namespace

BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y) {
  const std::int64_t by = block_along(tiling, 1, y);
  return {by, y - by * (tiling.block_size[1] - 1)};
}

LayerRows::LayerRows(const BlockTiling& tiling, const Layer& layer, Extent extent,
                     PointBits BlockResult::*bits)
    : tiling_(tiling), parts_(static_cast<std::size_t>(tiling.blocks[1])) {
  const GridRegion region = extent == Extent::region ? tiling.region : tiling.region_with_halo;
  words_ = static_cast<std::size_t>((region.size()[0] + 63) / 64);
  const auto blocks_x = static_cast<std::size_t>(tiling.blocks[0]);
  for (std::size_t b = 0; b < layer.blocks.size(); ++b) {
    const BlockResult& result = layer.blocks[b];
    const PointBits& inside = result.*bits;
    if (inside.words.empty()) continue;
    const bool is_last = b % blocks_x == blocks_x - 1;
    const std::int64_t owned =
        is_last ? region.end[0] - result.block.first[0] : result.block.owned[0];
    auto& parts = parts_[b / blocks_x];
    for (std::int64_t column = 0; column < inside.columns; ++column) {
      parts.push_back(
          {inside.words.data() + inside.word_index(column, 0, 0), inside.size[1],
           result.block.first[0] - tiling.region.begin[0] + column * PointBits::column_step,
           inside.owned_in_column(column, owned)});
    }
  }
}

void LayerRows::merge_row(std::int64_t y, std::int64_t z, RowBits& row) const {
  row.assign(words_, 0);
  const BlockRow position = block_row_of(tiling_, y);
  for (const Part& part : parts_[static_cast<std::size_t>(position.by)]) {
    const std::uint64_t bits = part.words[z * part.rows + position.y];
    if (bits != 0) append_bits(row, part.position, bits, part.count);
  }
}

LayerCrossings::LayerCrossings(const BlockTiling& tiling, const Layer& layer, Extent extent)
    : tiling_(tiling), extent_(extent), blocks_(static_cast<std::size_t>(tiling.blocks[1])) {
  for (std::size_t b = 0; b < layer.blocks.size(); ++b)
    if (!layer.blocks[b].crossings.empty() || !layer.blocks[b].halo_crossings.empty())
      blocks_[b / static_cast<std::size_t>(tiling.blocks[0])].push_back(&layer.blocks[b]);
}

Plane last_plane(const BlockTiling& tiling, const Layer& layer) {
  const LayerRows rows(tiling, layer, Extent::with_halo);
  Plane plane;
  RowBits row;
  for (std::int64_t y = 0; y < tiling.region_with_halo.size()[1]; ++y) {
    rows.merge_row(y, layer.owned_planes() - 1, row);
    plane.insert(plane.end(), row.begin(), row.end());
  }
  return plane;
}

// At the end of the grid, the points themselves replace their missing neighbours.
PointCounts count_points(const BlockTiling& tiling, const Plane& below, const Layer& layer,
                         const RowRange& rows) {
  const LayerRows merged(tiling, layer, Extent::with_halo);
  const GridIndex size = tiling.region.size();
  const std::int64_t rows_y = tiling.region_with_halo.size()[1];
  const bool ends_grid = tiling.region.end[0] == tiling.grid_size[0];
  RowBits row, previous, next, lower, upper;
  const auto merge = [&](bool exists, std::int64_t y, std::int64_t z, RowBits& neighbour) {
    if (exists)
      merged.merge_row(y, z, neighbour);
    else
      neighbour = row;
  };
  PointCounts counts;
  rows.for_each(size[1], [&](std::int64_t y, std::int64_t z) {
    if (y > 0 && !next.empty()) {
      previous.swap(row);
      row.swap(next);
    } else {
      merged.merge_row(y, z, row);
      merge(y > 0, y - 1, z, previous);
    }
    merge(y + 1 < rows_y, y + 1, z, next);
    merge(z > 0, y, z - 1, lower);
    merge(layer.first_z() + z + 1 < tiling.grid_size[2], y, z + 1, upper);
    const std::span<const std::uint64_t> under =
        z > 0 || below.empty()
            ? std::span<const std::uint64_t>(lower)
            : std::span(below).subspan(static_cast<std::size_t>(y) * row.size(), row.size());
    std::int64_t owned = size[0];
    for (std::size_t w = 0; owned > 0; ++w, owned -= 64) {
      const std::uint64_t bits = row[w],
                          last = std::uint64_t{1} << (std::min<std::int64_t>(owned, 64) - 1);
      const std::uint64_t left = bits << 1 | (w > 0 ? row[w - 1] >> 63 : bits & 1);
      const std::uint64_t right = bits >> 1 | (w + 1 < row.size() ? row[w + 1] << 63 : 0) |
                                  (ends_grid && owned <= 64 ? bits & last : 0);
      const std::uint64_t differ = (bits ^ left) | (bits ^ right) | (bits ^ previous[w]) |
                                   (bits ^ next[w]) | (bits ^ under[w]) | (bits ^ upper[w]);
      const std::uint64_t inside = bits & low_bits(owned), irregular = differ & low_bits(owned);
      if ((inside | irregular) == 0) continue;
      counts.inside += std::popcount(inside);
      counts.inside_regular += std::popcount(inside & ~irregular);
      counts.irregular += std::popcount(irregular);
    }
  });
  return counts;
}

}  // namespace eses::detail
