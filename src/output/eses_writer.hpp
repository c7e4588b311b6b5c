#pragma once
/// Text of the files of ESES, line by line.

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"
#include "input/file_index.hpp"
#include "output/number_text.hpp"
#include "output/text_token.hpp"

namespace eses::detail {

/// A growing buffer of text. Its memory is reused without being cleared.
class TextBuffer {
 public:
  /// Reserves space for `bytes` more bytes and returns its start. `advance_to` sets the end of the
  /// text.
  char* reserve(std::size_t bytes) {
    if (size_ + bytes > bytes_.size()) grow(bytes);
    return bytes_.data() + size_;
  }
  void advance_to(const char* end) { size_ = static_cast<std::size_t>(end - bytes_.data()); }
  /// Replaces the bytes from `begin` on by the bytes of a value.
  template <class Value>
  void replace(std::size_t begin, const Value& value) {
    std::memcpy(&bytes_[begin], &value, sizeof value);
  }
  void clear() { size_ = 0; }
  std::span<const char> text() const { return {bytes_.data(), size_}; }

 private:
  void grow(std::size_t bytes);

  std::vector<char> bytes_;  // only grows, so that reused bytes are not initialized again
  std::size_t size_ = 0;
};

/// Indices and coordinates of a grid as text. Each is formatted once and copied many times.
class GridText {
 public:
  /// The list of `file_indices` must outlive this object.
  GridText(const Grid& grid, const GridRegion& region, const FileIndices& file_indices = {});

  /// Returns the memory of a grid's text in bytes.
  static double memory_bytes(const Grid& grid) {
    return static_cast<double>(grid.size[0] + grid.size[1] + grid.size[2]) * sizeof(TextToken<16>) +
           coordinate_text_bytes(grid);
  }

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

  /// Writes one line. `first` is the index of the first component of its normal in `numbers`.
  char* append_crossing(char* out, std::int64_t x, const RowText& row,
                        const BlockCrossing& crossing, const NumberBatch& numbers,
                        std::size_t first) const;

  std::array<std::vector<TextToken<16>>, 3> indices_;  // by axis
  CoordinateTexts coordinates_;
  FileIndices file_indices_;
  std::int64_t first_x_ = 0;
  std::vector<std::array<std::uint64_t, 2>> row_indices_;  ///< text along x, padded with zero bytes
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
