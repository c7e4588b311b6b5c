#include "run/solved_block.hpp"

#include <algorithm>

#include "solve/block_solver.hpp"

namespace eses::detail {

const BlockBounds& SolvedBlock::block() const { return result_->block; }

bool SolvedBlock::is_inside(const GridIndex& point) const {
  const GridIndex& first = result_->block.first;
  return result_->inside.test({point[0] - first[0], point[1] - first[1], point[2] - first[2]});
}

void SolvedBlock::mark_inside(std::int64_t y, std::int64_t z, std::span<std::uint8_t> row) const {
  const PointBits& inside = result_->inside;
  if (inside.words.empty()) return;
  const GridIndex& first = result_->block.first;
  const auto size = static_cast<std::int64_t>(row.size());
  for (std::int64_t column = 0; column < inside.columns; ++column) {
    const std::int64_t begin = column * PointBits::column_step;
    if (begin >= size) return;
    const std::uint64_t word = inside.words[inside.word_index(column, y - first[1], z - first[2])];
    for_each_bit(word & low_bits(size - begin),
                 [&](int bit) { row[static_cast<std::size_t>(begin + bit)] = 1; });
  }
}

std::span<const BlockCrossing> SolvedBlock::crossings() const { return result_->crossings; }

std::span<const BlockCrossing> SolvedBlock::crossings_of_row(std::int64_t y, std::int64_t z) const {
  if (result_->crossings.empty()) return {};
  const BlockBounds& block = result_->block;
  const auto row =
      static_cast<std::size_t>((z - block.first[2]) * block.owned[1] + y - block.first[1]);
  const std::uint32_t begin = result_->row_begin[row], end = result_->row_begin[row + 1];
  return std::span(result_->crossings).subspan(begin, end - begin);
}

double SolvedBlock::seconds() const { return result_->seconds; }

}  // namespace eses::detail
