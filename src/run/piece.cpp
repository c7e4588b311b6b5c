#include "run/piece.hpp"

#include <algorithm>

#include "geometry/map_rows.hpp"

namespace eses::detail {
namespace {

std::size_t words_of(const GridRegion& region) {
  return static_cast<std::size_t>((region.size()[0] + 63) / 64);
}

// Sets the bits and fractions of the edges of the last row that the surface crosses.
void set_fractions(const BlockTiling& tiling, const Layer& layer, std::size_t axis, std::int64_t y,
                   std::int64_t z, std::uint32_t row, MapRows& edges) {
  const std::size_t begin = edges.bits.size() - words_of(tiling.region);
  const BlockRow position = block_row_of(tiling, y);
  for (std::int64_t bx = 0; bx < tiling.blocks[0]; ++bx) {
    const BlockResult& result =
        layer.blocks[static_cast<std::size_t>(position.by * tiling.blocks[0] + bx)];
    if (result.fractions.edges.empty()) continue;
    const auto row_in_block = static_cast<std::size_t>(z * result.block.owned[1] + position.y);
    const std::int64_t first_x = result.block.first[0] - tiling.region.begin[0];
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

// Appends the edges along an axis from row (y, z). `y` counts from the region's first row, `z` from
// the layer's first plane. `row` is the number of the row among those of `edges`. Edges that would
// end beyond the grid have no bits.
void append_edges(const BlockTiling& tiling, const Layer& layer, std::size_t axis, std::int64_t y,
                  std::int64_t z, std::uint32_t row, MapRows& edges) {
  const LayerBits::Row lower = layer.inside.row(y, z);
  const std::int64_t index = axis == 1 ? tiling.region.begin[1] + y : layer.first_z() + z;
  const bool has_edges = axis == 0 || index + 1 < tiling.grid_size[axis];
  const LayerBits::Row next =
      has_edges ? layer.inside.row(axis == 1 ? y + 1 : y, axis == 2 ? z + 1 : z) : lower;
  const auto upper = [&](std::size_t w) {
    if (axis > 0) return next[w];
    return lower[w] >> 1 | (w + 1 < lower.size() ? lower[w + 1] << 63 : 0);
  };
  for (std::size_t w = 0; w < words_of(tiling.region); ++w)
    edges.bits.push_back(has_edges ? lower[w] & upper(w) : 0);
  set_fractions(tiling, layer, axis, y, z, row, edges);
}

// Makes rows of a map from a layer. `rows` are counted from the first plane of the layer.
void make_map_rows(const BlockTiling& tiling, const Layer& layer, MapQuantity quantity,
                   const RowRange& rows, MapRows& made) {
  made.clear();
  const GridIndex size = tiling.region.size();
  const LayerBits& points = quantity == MapQuantity::ion_access ? layer.covered : layer.inside;
  std::uint32_t count = 0;
  rows.for_each(size[1], [&](std::int64_t y, std::int64_t z) {
    if (is_of_edges(quantity))
      return append_edges(tiling, layer, edge_axis(quantity), y, z, count++, made);
    const LayerBits::Row row = points.row(y, z).first(words_of(tiling.region));
    made.bits.insert(made.bits.end(), row.begin(), row.end());
    made.bits.back() &= low_bits((size[0] - 1) % 64 + 1);  // without the halo
  });
}

}  // namespace

PieceMaker::PieceMaker(const Grid& grid, const BlockTiling& tiling, const Outputs& outputs,
                       FileIndices file_indices)
    : tiling_(tiling),
      has_grid_(outputs.grid),
      has_edges_(outputs.edges),
      gzip_(outputs.gzip),
      text_(grid, tiling.region, file_indices),
      batches_(tiling.region, outputs.gzip) {
  for (const MapChoice& map : chosen_maps(outputs)) maps_.push_back(map.quantity);
}

void PieceMaker::make(const Layer& layer, const RowRange& rows, Scratch& scratch,
                      RowPiece& piece) const {
  const GridRegion& region = tiling_.region;
  piece.first_row = (layer.first_z() - region.begin[2]) * region.size()[1] + rows.begin;
  piece.grid.buffer.clear();
  piece.edges.buffer.clear();
  if (has_grid_) append_points(layer, rows, piece.grid.buffer);
  if (has_edges_) append_crossings(layer, rows, piece.edges.buffer);
  if (gzip_) {
    compress(piece.grid.buffer, scratch);
    compress(piece.edges.buffer, scratch);
  }
  for (const MapQuantity quantity : maps_)
    make_map_rows(tiling_, layer, quantity, rows,
                  piece.map_rows[static_cast<std::size_t>(quantity)]);
}

// Formats rows of points as text.
void PieceMaker::append_points(const Layer& layer, const RowRange& rows, TextBuffer& text) const {
  const GridRegion& region = tiling_.region;
  rows.for_each(region.size()[1], [&](std::int64_t y, std::int64_t z) {
    text_.append_row(text, region.begin[1] + y, layer.first_z() + z, layer.inside.row(y, z));
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
