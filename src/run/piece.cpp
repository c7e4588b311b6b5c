#include "run/piece.hpp"

#include <algorithm>
#include <utility>

#include "grid/map_rows.hpp"

namespace eses::detail {
namespace {

PointBits BlockResult::*bits_of(MapQuantity quantity) {
  return quantity == MapQuantity::ion_access ? &BlockResult::covered : &BlockResult::inside;
}

// Rows of edges also need the points of the halo, at which edges of the region end.
Extent extent_of(MapQuantity quantity) {
  return is_of_edges(quantity) ? Extent::with_halo : Extent::region;
}

// Makes rows of a map from the blocks of a layer.
class MapRowMaker {
 public:
  MapRowMaker(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity)
      : tiling_(tiling),
        layer_(layer),
        quantity_(quantity),
        rows_(tiling, layer, extent_of(quantity), bits_of(quantity)) {}

  // These functions append row (y, z). `y` counts from the region's first row, `z` from the layer's
  // first plane. `row` is the number of the row among those of `edges`.
  void append_points(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& bits);
  void append_edges(std::int64_t y, std::int64_t z, std::uint32_t row, MapRows& edges);

 private:
  bool merge_upper_ends(std::int64_t y, std::int64_t z);

  const BlockTiling& tiling_;
  const Layer& layer_;
  MapQuantity quantity_;
  LayerRows rows_;
  RowBits lower_, upper_;  // inside bits of the lower and upper ends of the edges of a row
};

void MapRowMaker::append_points(std::int64_t y, std::int64_t z, std::vector<std::uint64_t>& bits) {
  rows_.merge_row(y, z, lower_);
  bits.insert(bits.end(), lower_.begin(), lower_.end());
}

// Merges the row of the upper ends of edges into `upper_`. Returns false if the edges would end
// beyond the grid.
bool MapRowMaker::merge_upper_ends(std::int64_t y, std::int64_t z) {
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

void MapRowMaker::append_edges(std::int64_t y, std::int64_t z, std::uint32_t row, MapRows& edges) {
  const auto axis = static_cast<std::uint8_t>(edge_axis(quantity_));
  rows_.merge_row(y, z, lower_);
  upper_.assign(lower_.size(), 0);
  const bool has_edges = merge_upper_ends(y, z);
  const std::size_t begin = edges.bits.size();
  const auto cells = static_cast<std::size_t>((tiling_.region.size()[0] + 63) / 64);
  for (std::size_t cell = 0; cell < cells; ++cell)
    edges.bits.push_back(has_edges ? lower_[cell] & upper_[cell] : 0);
  const BlockRow position = block_row_of(tiling_, y);
  for (std::int64_t bx = 0; bx < tiling_.blocks[0]; ++bx) {
    const BlockResult& result =
        layer_.blocks[static_cast<std::size_t>(position.by * tiling_.blocks[0] + bx)];
    if (result.fractions.edges.empty()) continue;
    const auto row_in_block = static_cast<std::size_t>(z * result.block.owned[1] + position.y);
    const std::int64_t first_x = result.block.first[0] - tiling_.region.begin[0];
    const std::vector<std::uint32_t>& row_begin = result.fractions.row_begin;
    for (std::uint32_t e = row_begin[row_in_block]; e < row_begin[row_in_block + 1]; ++e) {
      const InsideFractions::Edge& edge = result.fractions.edges[e];
      if (edge.axis != axis) continue;
      const auto x = static_cast<std::uint32_t>(first_x + edge.x);
      std::uint64_t& bits = edges.bits[begin + x / 64];
      const std::uint64_t bit = std::uint64_t{1} << (x % 64);
      bits = edge.fraction == whole_edge ? bits | bit : bits & ~bit;
      if (edge.fraction != 0 && edge.fraction != whole_edge)
        edges.partial_edges.push_back({row, x, edge.fraction});
    }
  }
}

// Makes rows of a map from the blocks of a layer. `rows` are counted from the first plane of the
// layer.
void make_map_rows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity,
                   const RowRange& rows, MapRows& made) {
  made.clear();
  MapRowMaker maker(tiling, layer, quantity);
  std::uint32_t row = 0;
  rows.for_each(tiling.region.size()[1], [&](std::int64_t y, std::int64_t z) {
    if (is_of_edges(quantity))
      maker.append_edges(y, z, row++, made);
    else
      maker.append_points(y, z, made.bits);
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
  for (const MapQuantity quantity : contents_.maps)
    make_map_rows(tiling_, layer, quantity, rows,
                  piece.map_rows[static_cast<std::size_t>(quantity)]);
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
