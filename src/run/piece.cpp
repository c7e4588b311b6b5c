#include "run/piece.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "grid/inside_fraction.hpp"

namespace eses::detail {
namespace {

PointBits BlockResult::*bits_of(MapQuantity quantity) {
  return quantity == MapQuantity::ion_access ? &BlockResult::covered : &BlockResult::inside;
}

// Rows of edges also need the points of the halo, at which edges of the region end.
Extent extent_of(MapQuantity quantity) {
  return is_of_edges(quantity) ? Extent::with_halo : Extent::region;
}

// Appends the inside fractions of 64 edges, two in a word. Set bits stand for edges that are wholly
// inside, others for edges that are wholly outside.
void append_whole_edges(std::uint64_t bits, std::vector<std::uint64_t>& words) {
  constexpr std::uint64_t low = whole_edge, high = std::uint64_t{whole_edge} << 32;
  constexpr std::array<std::uint64_t, 4> pairs{0, low, high, low | high};
  constexpr std::size_t words_of_cell = 64 / fractions_per_word;
  const std::size_t begin = words.size();
  words.resize(begin + words_of_cell, 0);
  if (bits == 0) return;
  for (std::size_t pair = 0; pair < words_of_cell; ++pair)
    words[begin + pair] = pairs[bits >> (2 * pair) & 3];
}

// Makes rows of words from the blocks of a layer.
class MapRows {
 public:
  MapRows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity)
      : tiling_(tiling),
        layer_(layer),
        quantity_(quantity),
        rows_(tiling, layer, extent_of(quantity), bits_of(quantity)) {}

  // These functions append row (y, z). `y` counts from the region's first row, `z` from the layer's
  // first plane.
  void append_points(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words);
  void append_edges(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words);

 private:
  bool merge_upper_ends(std::int64_t y, std::int64_t z);

  const BlockTiling& tiling_;
  const Layer& layer_;
  MapQuantity quantity_;
  LayerRows rows_;
  RowBits lower_, upper_;  // inside bits of the lower and upper ends of the edges of a row
};

void MapRows::append_points(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words) {
  rows_.merge_row(y, z, lower_);
  words.insert(words.end(), lower_.begin(), lower_.end());
}

// Merges the row of the upper ends of edges into `upper_`. Returns false if the edges would end
// beyond the grid.
bool MapRows::merge_upper_ends(std::int64_t y, std::int64_t z) {
  const std::size_t axis = edge_axis(quantity_);
  if (axis == 0) {
    for (std::size_t w = 0; w < lower_.size(); ++w)
      upper_[w] = lower_[w] >> 1 | (w + 1 < lower_.size() ? lower_[w + 1] << 63 : 0);
    return true;
  }
  const std::int64_t index = axis == 1 ? tiling_.region.begin[1] + y : layer_.first_z() + z;
  if (index + 1 >= tiling_.grid_size[axis]) return false;
  rows_.merge_row(axis == 1 ? y + 1 : y, axis == 2 ? z + 1 : z, upper_);
  return true;
}

void MapRows::append_edges(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& words) {
  const auto axis = static_cast<std::uint8_t>(edge_axis(quantity_));
  rows_.merge_row(y, z, lower_);
  upper_.assign(lower_.size(), 0);
  const bool has_edges = merge_upper_ends(y, z);
  const std::size_t begin = words.size();
  const auto cells = static_cast<std::size_t>((tiling_.region.size()[0] + 63) / 64);
  for (std::size_t cell = 0; cell < cells; ++cell)
    append_whole_edges(has_edges ? lower_[cell] & upper_[cell] : 0, words);
  const BlockRow position = block_row_of(tiling_, y);
  for (std::int64_t bx = 0; bx < tiling_.blocks[0]; ++bx) {
    const BlockResult& result =
        layer_.blocks[static_cast<std::size_t>(position.by * tiling_.blocks[0] + bx)];
    if (result.fractions.edges.empty()) continue;
    const auto row = static_cast<std::size_t>(z * result.block.owned[1] + position.y);
    const std::int64_t first_x = result.block.first[0] - tiling_.region.begin[0];
    for (std::uint32_t e = result.fractions.row_begin[row]; e < result.fractions.row_begin[row + 1];
         ++e) {
      const InsideFractions::Edge& edge = result.fractions.edges[e];
      if (edge.axis != axis) continue;
      const auto x = static_cast<std::size_t>(first_x + edge.x);
      set_fraction(words[begin + x / fractions_per_word], x, edge.fraction);
    }
  }
}

// Appends rows of words for GridMap from the blocks of a layer. `rows` are counted from the first
// plane of the layer.
void append_map_rows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity,
                     const RowRange& rows, std::vector<std::uint64_t>& words) {
  MapRows map_rows(tiling, layer, quantity);
  rows.for_each(tiling.region.size()[1], [&](std::int64_t y, std::int64_t z) {
    if (is_of_edges(quantity))
      map_rows.append_edges(y, z, words);
    else
      map_rows.append_points(y, z, words);
  });
}

}  // namespace

PieceMaker::PieceMaker(const Grid& grid, const BlockTiling& tiling, SweepContents contents,
                       FileIndices file_indices)
    : tiling_(tiling),
      contents_(std::move(contents)),
      text_(grid, tiling.region, file_indices),
      batches_(tiling.region, contents_.gzip) {}

void PieceMaker::make(const Layer& layer, const RowRange& rows, Scratch& scratch,
                      Piece& piece) const {
  const GridRegion& region = tiling_.region;
  piece.first_row = (layer.first_z() - region.begin[2]) * region.size()[1] + rows.begin;
  piece.grid.buffer.clear();
  piece.edges.buffer.clear();
  if (contents_.grid) append_points(layer, rows, scratch, piece.grid.buffer);
  if (contents_.edges) append_crossings(layer, rows, piece.edges.buffer);
  if (contents_.gzip) {
    compress(piece.grid.buffer, scratch);
    compress(piece.edges.buffer, scratch);
  }
  for (const MapQuantity quantity : contents_.maps) {
    std::vector<std::uint64_t>& words = piece.map_rows[static_cast<std::size_t>(quantity)];
    words.clear();
    append_map_rows(tiling_, layer, quantity, rows, words);
  }
}

// Formats rows of points as text.
void PieceMaker::append_points(const Layer& layer, const RowRange& rows, Scratch& scratch,
                               TextBuffer& text) const {
  const GridRegion& region = tiling_.region;
  const LayerRows layer_rows(tiling_, layer);
  rows.for_each(region.size()[1], [&](std::int64_t y, std::int64_t z) {
    layer_rows.merge_row(y, z, scratch.row);
    text_.append_row(text, region.begin[1] + y, layer.first_z() + z, scratch.row);
  });
}

void PieceMaker::append_crossings(const Layer& layer, const RowRange& rows,
                                  TextBuffer& text) const {
  const GridRegion& region = tiling_.region;
  const LayerCrossings crossings(tiling_, layer);
  rows.for_each(region.size()[1], [&](std::int64_t y, std::int64_t z) {
    crossings.for_each_row_part(
        y, z, [&](std::int64_t first_x, std::span<const BlockCrossing> part) {
          text_.append_crossings(text, first_x, region.begin[1] + y, layer.first_z() + z, part);
        });
  });
}

// Replaces a text by a member of a gzip file. There are no members without text.
void PieceMaker::compress(TextBuffer& text, Scratch& scratch) const {
  if (text.text().empty()) return;
  if (!scratch.gzip) scratch.gzip.emplace();
  const std::span<const char> member = scratch.gzip->member(text.text());
  text.clear();
  text.advance_to(std::copy(member.begin(), member.end(), text.reserve(member.size())));
}

}  // namespace eses::detail
