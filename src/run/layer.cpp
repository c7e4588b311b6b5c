#include "run/layer.hpp"

#include <algorithm>
#include <bit>

namespace eses {
namespace {

// Appends the low `count` bits of `bits` behind `position` bits of a row that was zero from there.
void append_bits(RowBits& row, std::int64_t position, std::uint64_t bits, std::int64_t count) {
  bits &= low_bits(count);
  const auto word = static_cast<std::size_t>(position / 64);
  const int shift = static_cast<int>(position % 64);
  row[word] |= bits << shift;
  if (shift + count > 64) row[word + 1] |= bits >> (64 - shift);
}

}  // namespace

BlockRow block_row_of(const BlockTiling& tiling, std::int64_t y) {
  const std::int64_t by = std::min(y / (tiling.block_size - 1), tiling.blocks[1] - 1);
  return {by, y - by * (tiling.block_size - 1)};
}

LayerRows::LayerRows(const BlockTiling& tiling, const Layer& layer)
    : tiling_(tiling), pieces_(static_cast<std::size_t>(tiling.blocks[1])) {
  for (std::size_t b = 0; b < layer.blocks.size(); ++b) {
    const BlockResult& result = layer.blocks[b];
    const PointBits& inside = result.inside;
    if (inside.words.empty()) continue;
    auto& pieces = pieces_[b / static_cast<std::size_t>(tiling.blocks[0])];
    for (std::int64_t column = 0; column < inside.columns; ++column) {
      pieces.push_back({inside.words.data() + inside.word_index(column, 0, 0), inside.size[1],
                        result.block.first[0] + column * PointBits::column_step,
                        inside.owned_in_column(column, result.block.owned[0])});
    }
  }
}

void LayerRows::join(std::int64_t y, std::int64_t z, RowBits& row) const {
  row.assign(static_cast<std::size_t>((tiling_.grid_size[0] + 63) / 64), 0);
  const BlockRow place = block_row_of(tiling_, y);
  for (const Piece& piece : pieces_[static_cast<std::size_t>(place.by)]) {
    const std::uint64_t bits = piece.words[z * piece.rows + place.y];
    if (bits != 0) append_bits(row, piece.position, bits, piece.count);
  }
}

void PointCounts::add(const PointCounts& other) {
  inside += other.inside;
  inside_regular += other.inside_regular;
  irregular += other.irregular;
}

Plane last_plane(const BlockTiling& tiling, const Layer& layer) {
  const LayerRows rows(tiling, layer);
  Plane plane;
  plane.rows.resize(static_cast<std::size_t>(tiling.grid_size[1]));
  for (std::int64_t y = 0; y < tiling.grid_size[1]; ++y)
    rows.join(y, layer.owned_planes() - 1, plane.rows[static_cast<std::size_t>(y)]);
  return plane;
}

RowWindow::RowWindow(const BlockTiling& tiling, const Plane& below, const Layer& layer)
    : tiling_(tiling), below_(below), layer_(layer), layer_rows_(tiling, layer) {}

void RowWindow::load(std::int64_t y, std::int64_t z, RowBits& row) const {
  if (z < 0) {
    row = below_.rows[static_cast<std::size_t>(y)];
  } else {
    layer_rows_.join(y, z, row);
  }
}

void RowWindow::move_to(std::int64_t y, std::int64_t z) {
  const std::int64_t last_y = tiling_.grid_size[1] - 1;
  if (z == z_ && y == y_ + 1) {
    rows_[0].swap(rows_[1]);
    rows_[1].swap(rows_[2]);
  } else {
    load(y, z, rows_[1]);
    load(std::max<std::int64_t>(y - 1, 0), z, rows_[0]);
  }
  load(std::min(y + 1, last_y), z, rows_[2]);
  const bool is_first_plane = z == 0 && below_.rows.empty();
  const bool is_last_plane = layer_.first_z() + z == tiling_.grid_size[2] - 1;
  load(y, is_first_plane ? z : z - 1, planes_[0]);
  load(y, is_last_plane ? z : z + 1, planes_[1]);
  y_ = y;
  z_ = z;
}

PointCounts RowWindow::count() const {
  PointCounts counts;
  const RowBits& row = rows_[1];
  const std::int64_t points = tiling_.grid_size[0];
  for (std::size_t w = 0; w < row.size(); ++w) {
    const std::int64_t in_word = points - static_cast<std::int64_t>(w) * 64;
    const std::uint64_t bits = row[w];
    // The neighbours along x; beyond both ends of the row the point itself.
    const std::uint64_t from_left = w > 0 ? row[w - 1] >> 63 : bits & 1;
    const std::uint64_t left = bits << 1 | from_left;
    std::uint64_t right = bits >> 1;
    if (in_word > 64) {
      right |= row[w + 1] << 63;
    } else {
      right |= bits & (std::uint64_t{1} << (in_word - 1));
    }
    const std::uint64_t differ = (bits ^ left) | (bits ^ right) | (bits ^ rows_[0][w]) |
                                 (bits ^ rows_[2][w]) | (bits ^ planes_[0][w]) |
                                 (bits ^ planes_[1][w]);
    const std::uint64_t irregular = differ & low_bits(in_word);
    // Most words are all outside or all inside; the baseline instruction set counts bits slowly.
    if (irregular == 0 && (bits == 0 || bits == ~std::uint64_t{0})) {
      counts.inside += bits == 0 ? 0 : 64;
      counts.inside_regular += bits == 0 ? 0 : 64;
      continue;
    }
    counts.inside += std::popcount(bits);
    counts.inside_regular += std::popcount(bits & ~irregular);
    counts.irregular += std::popcount(irregular);
  }
  return counts;
}

}  // namespace eses
