#pragma once
/// One bit for each grid point of a block.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/grid.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// Bits of the points of a block. Rows along x are divided into columns of 64 points. Neighbouring
/// columns share one point, so that both ends of each edge along x are in the same word: column c
/// has the points [63 c, 63 c + 64).
struct PointBits {
  static constexpr std::int64_t column_points = 64;
  static constexpr std::int64_t column_step = 63;

  GridIndex size{};                  ///< number of points along x, y and z
  std::int64_t columns = 0;          ///< number of columns
  std::vector<std::uint64_t> words;  ///< [column][z][y]; no words mean that no bit is set

  /// Returns the number of words for this number of points, without padding.
  static std::int64_t word_count(const GridIndex& points) {
    return columns_of(points) * points[1] * points[2];
  }

  /// Clears all bits and frees the words.
  void reset_empty(const GridIndex& new_size) {
    size = new_size;
    columns = columns_of(size);
    words.clear();
  }
  /// Sets the size and clears all bits.
  void reset(const GridIndex& new_size) {
    reset_empty(new_size);
    words.assign(static_cast<std::size_t>(word_count(size)) + vector_padding, 0);
  }
  /// Returns the number of points that a column owns, if the row owns its first `owned` points. A
  /// column owns its first points, but not the point that it shares with the next column.
  std::int64_t owned_in_column(std::int64_t column, std::int64_t owned) const {
    return std::min(owned - column * column_step,
                    column + 1 == columns ? column_points : column_step);
  }
  /// Returns whether the bit of a point is set.
  bool test(const GridIndex& point) const {
    if (words.empty()) return false;
    const std::int64_t column = std::min(point[0] / column_step, columns - 1);
    return (words[word_index(column, point[1], point[2])] >> (point[0] - column * column_step) &
            1) != 0;
  }
  std::size_t word_index(std::int64_t column, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((column * size[2] + z) * size[1] + y);
  }

 private:
  static std::int64_t columns_of(const GridIndex& points) {
    return points[0] < 2 ? 1 : (points[0] - 2) / column_step + 1;
  }
};

/// Returns a word with the bits [0, count) set, for 0 <= count <= 64.
constexpr std::uint64_t low_bits(std::int64_t count) {
  return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

/// Calls `action(bit)` for each set bit of `word`, in ascending order.
template <class Action>
void for_each_bit(std::uint64_t word, Action&& action) {
  for (; word != 0; word &= word - 1) action(std::countr_zero(word));
}

}  // namespace eses::detail
