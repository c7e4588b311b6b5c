#include "run/piece.hpp"

#include <algorithm>
#include <utility>

#include "run/map_rows.hpp"

namespace eses::detail {

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
