#include "run/layer.hpp"

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

Plane last_plane(const Layer& layer) {
  Plane plane;
  plane.blocks.resize(layer.blocks.size());
  for (std::size_t b = 0; b < layer.blocks.size(); ++b) {
    const PointBits& inside = layer.blocks[b].inside;
    if (inside.words.empty()) continue;
    for (std::int64_t column = 0; column < inside.columns; ++column) {
      const auto words = std::span(inside.words)
                             .subspan(inside.word_index(column, 0, layer.owned_planes() - 1),
                                      static_cast<std::size_t>(inside.size[1]));
      plane.blocks[b].insert(plane.blocks[b].end(), words.begin(), words.end());
    }
  }
  return plane;
}

}  // namespace eses::detail
