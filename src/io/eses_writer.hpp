#pragma once
/// The text of ESES's files, line by line.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"
#include "io/number_text.hpp"

namespace eses::detail {

/// Text under construction: grows, and is reused without being cleared.
class TextBuffer {
 public:
  /// Room for `bytes` more, and where they go; `advance_to` ends them.
  char* reserve(std::size_t bytes);
  void advance_to(const char* end) { size_ = static_cast<std::size_t>(end - bytes_.data()); }
  void clear() { size_ = 0; }
  std::span<const char> text() const { return {bytes_.data(), size_}; }

 private:
  std::vector<char> bytes_;  // resized only to grow, so that nothing is filled twice
  std::size_t size_ = 0;
};

/// Indices and coordinates of a grid along its axes as text, made once and copied many times.
class GridText {
 public:
  /// `atom_numbers` are what crossings' atoms are called, by index, or empty if that is their
  /// index; they must outlive this.
  GridText(const Grid& grid, const GridRegion& region,
           std::span<const AtomIndex> atom_numbers = {});

  /// A row of grid_info.txt: `i j k s` for the points of the region; bit 0 of `inside` tells the
  /// sign s of the first.
  void append_row(TextBuffer& text, std::int64_t y, std::int64_t z,
                  std::span<const std::uint64_t> inside) const;

  /// Lines of intersection_info.txt for crossings whose lower points are (first_x + x, y, z).
  void append_crossings(TextBuffer& text, std::int64_t first_x, std::int64_t y, std::int64_t z,
                        std::span<const BlockCrossing> crossings) const;

 private:
  /// Text with a blank behind it, and its length in the last byte.
  template <std::size_t bytes>
  struct Token {
    using Twice = Token<2 * bytes>;
    std::array<char, bytes - 1> text{};
    std::uint8_t length = 0;
  };
  struct RowText;
  RowText row_text(std::int64_t y, std::int64_t z) const;

  /// One line; its normal and coordinate are the numbers from `first`.
  char* append_crossing(char* out, std::int64_t x, const RowText& row,
                        const BlockCrossing& crossing, const NumberBatch& numbers,
                        std::size_t first) const;

  struct Axis {
    std::vector<Token<16>> indices;
    std::vector<Token<32>> coordinates;
  };
  std::array<Axis, 3> axes_;
  std::span<const AtomIndex> atom_numbers_;
  std::int64_t first_x_ = 0;
  std::vector<std::array<std::uint64_t, 2>> row_indices_;  ///< along x, with zeros behind the text
};

/// Upper bound of the bytes of grid_info.txt.
std::uint64_t max_grid_bytes(const GridRegion& region);

/// A line of intersection_info.txt, typically.
inline constexpr std::uint64_t typical_crossing_bytes = 150;

/// bounding_box.txt
std::string bounding_box_text(const Grid& grid);

/// Lines of partition_area.txt for atoms first, first + 1, ...
void append_areas(TextBuffer& text, std::size_t first, std::span<const double> areas);

}  // namespace eses::detail
