#pragma once
/// Text of the files of ESES, line by line.

#include <cstdint>
#include <span>
#include <string>

#include "eses/grid.hpp"
#include "geometry/block_crossing.hpp"
#include "input/atom_names.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail {

/// Indices and coordinates of a grid as text. Each is formatted once and copied many times.
class GridText {
 public:
  /// The list of `file_indices` must outlive this object.
  GridText(const Grid& grid, const GridRegion& region, const FileIndices& file_indices = {});

  /// Returns the memory of a grid's text in bytes.
  static double memory_bytes(const Grid& grid) { return 2 * token_bytes(grid); }

  /// Appends a row of grid_info.txt: `i j k s` for the points of the region. Bit i of `inside` is
  /// the sign s of point i.
  void append_row(TextBuffer& text, std::int64_t y, std::int64_t z,
                  std::span<const std::uint64_t> inside) const;

  /// Appends lines of intersection_info.txt for crossings whose lower points are (first_x + x, y,
  /// z).
  void append_crossings(TextBuffer& text, std::int64_t first_x, std::int64_t y, std::int64_t z,
                        std::span<const BlockCrossing> crossings) const;

 private:
  struct RowText;
  RowText row_text(std::int64_t y, std::int64_t z) const;

  char* put_crossing(char* out, std::size_t x, const RowText& row,
                     const BlockCrossing& crossing) const;

  TokensOfAxes indices_, coordinates_;
  FileIndices file_indices_;
  std::size_t begin_x_, end_x_;  // indices of the points of a row
};

/// Returns an upper bound of the size of grid_info.txt in bytes.
std::uint64_t max_grid_bytes(const GridRegion& region);

/// Typical length of a line of intersection_info.txt.
inline constexpr std::uint64_t typical_crossing_bytes = 150;

/// Returns the text of bounding_box.txt.
std::string bounding_box_text(const Grid& grid);

/// Appends lines of partition_area.txt for the atoms first, first + 1, ...
void append_areas(TextBuffer& text, std::size_t first, std::span<const double> areas);

}  // namespace eses::detail
