#include "output/eses_writer.hpp"

#include <algorithm>
#include <cstring>

#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Maximum length of a line of intersection_info.txt: 6 indices, 6 numbers and 3 atoms, each with a
// separator.
constexpr std::size_t max_crossing_line_length = 15 * (max_number_length + 1) + 1;

// Concatenates two indices. A copy of constant size is faster than one of the exact length.
TextToken concatenated(const TextToken& first, const TextToken& second) {
  constexpr std::size_t max_length = 15;  // of an index with its blank
  TextToken both = first;
  std::memcpy(both.text.data() + first.length, second.text.data(), max_length);
  both.length = static_cast<std::uint8_t>(first.length + second.length);
  return both;
}

std::size_t decimal_digits(std::uint64_t value) {
  std::size_t digits = 1;
  for (; value >= 10; value /= 10) ++digits;
  return digits;
}

// Copies `copied` bytes of a token, which is faster than its exact length.
template <std::size_t copied>
char* put_part(char* out, const TextToken& token) {
  std::memcpy(out, token.text.data(), copied);
  return out + token.length;
}

// Writes the lines of points: an index, and the rest of the line for the sign of the point.
template <std::size_t copied>
char* put_row(char* out, std::span<const TextToken> indices, std::span<const std::uint64_t> inside,
              const std::array<TextToken, 2>& rests) {
  for (std::size_t begin = 0; begin < indices.size(); begin += 64) {
    const auto part = indices.subspan(begin, std::min<std::size_t>(64, indices.size() - begin));
    std::uint64_t bits = inside[begin / 64];
    if (bits == 0 || bits == ~std::uint64_t{0}) {
      const TextToken rest = rests[bits & 1];
      for (const TextToken& index : part)
        out = put_part<copied>(put_part<copied>(out, index), rest);
    } else {
      for (const TextToken& index : part) {
        out = put_part<copied>(put_part<copied>(out, index), rests[bits & 1]);
        bits >>= 1;
      }
    }
  }
  return out;
}

}  // namespace

GridText::GridText(const Grid& grid, const GridRegion& region, const FileIndices& file_indices)
    : coordinates_(coordinate_tokens(grid)),
      file_indices_(file_indices),
      begin_x_(static_cast<std::size_t>(region.begin[0])),
      end_x_(static_cast<std::size_t>(region.end[0])) {
  std::array<char, max_number_length + 1> field{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(grid.size[axis]); ++i)
      indices_[axis].push_back(make_token({field.data(), put_index(field.data(), i)}));
}

void GridText::append_row(TextBuffer& text, std::int64_t y, std::int64_t z,
                          std::span<const std::uint64_t> inside) const {
  constexpr std::size_t short_copy = 16, long_copy = sizeof(TextToken) - 1;
  const std::string rest = formatted("{} {} ", y, z);
  const std::array<TextToken, 2> rests{make_token(rest + "-1\n"), make_token(rest + "1\n")};
  const auto indices = std::span(indices_[0]).subspan(begin_x_, end_x_ - begin_x_);
  const std::size_t longest = decimal_digits(end_x_) + 1 + rests[0].length;
  char* const out = text.reserve(indices.size() * longest + token_overrun);
  text.advance_to(rests[0].length <= short_copy ? put_row<short_copy>(out, indices, inside, rests)
                                                : put_row<long_copy>(out, indices, inside, rests));
}

// Text that the lines of one row share.
struct GridText::RowText {
  std::array<TextToken, 3> indices;  // `y z` of the upper ends of edges along x, y and z
  const TextToken &y, &z;            // coordinates
};

GridText::RowText GridText::row_text(std::int64_t y, std::int64_t z) const {
  const auto j = static_cast<std::size_t>(y), k = static_cast<std::size_t>(z);
  const auto& y_indices = indices_[1];
  const auto& z_indices = indices_[2];
  const std::size_t next_j = std::min(j + 1, y_indices.size() - 1);
  const std::size_t next_k = std::min(k + 1, z_indices.size() - 1);
  return {{concatenated(y_indices[j], z_indices[k]), concatenated(y_indices[next_j], z_indices[k]),
           concatenated(y_indices[j], z_indices[next_k])},
          coordinates_[1][j],
          coordinates_[2][k]};
}

void GridText::append_crossings(TextBuffer& text, std::int64_t first_x, std::int64_t y,
                                std::int64_t z, std::span<const BlockCrossing> crossings) const {
  char* out = text.reserve(crossings.size() * max_crossing_line_length + token_overrun);
  const RowText row = row_text(y, z);
  for (const BlockCrossing& crossing : crossings)
    out = put_crossing(out, static_cast<std::size_t>(first_x + crossing.x), row, crossing);
  text.advance_to(out);
}

// Writes the line of a crossing whose lower point has the index `x`.
char* GridText::put_crossing(char* out, std::size_t x, const RowText& row,
                             const BlockCrossing& crossing) const {
  const std::size_t axis = crossing.axis;
  const std::array<std::size_t, 2> x_index{x, x + (axis == 0)};
  const std::array<const TextToken*, 2> y_and_z{row.indices.data(), &row.indices[axis]};
  const std::size_t inner = crossing.lower_is_inside ? 0 : 1;
  for (const std::size_t end : {inner, 1 - inner}) {
    out = put_token(out, indices_[0][x_index[end]]);
    out = put_token(out, *y_and_z[end]);
  }
  const std::array<const TextToken*, 3> lower{&coordinates_[0][x], &row.y, &row.z};
  for (std::size_t q = 0; q < 3; ++q)
    out = axis == q ? put_number(out, crossing.coordinate) : put_token(out, *lower[q]);
  out = put_vector(out, crossing.normal);
  for (std::size_t q = 0; q < crossing.atom_count; ++q)
    out = put_index(out, as_number(file_indices_[crossing.atoms[q]]));
  *out++ = '\n';
  return out;
}

std::uint64_t max_grid_bytes(const GridRegion& region) {
  std::uint64_t line = 3;  // sign, digit and newline
  for (const std::int64_t n : region.end)
    line += static_cast<std::uint64_t>(decimal_digits(static_cast<std::uint64_t>(n - 1))) + 1;
  return static_cast<std::uint64_t>(region.point_count()) * line;
}

std::string bounding_box_text(const Grid& grid) {
  std::array<char, std::size_t{9} * (max_number_length + 1)> text{};
  char* out = text.data();
  for (const Vec3& corner : {grid.origin, grid.upper()}) out = end_line(put_vector(out, corner));
  for (const std::int64_t n : grid.size) out = put_index(out, static_cast<std::uint64_t>(n));
  return {text.data(), end_line(out)};
}

void append_areas(TextBuffer& text, std::size_t first, std::span<const double> areas) {
  char* out = text.reserve(areas.size() * (2 * max_number_length + 2));
  for (std::size_t i = 0; i < areas.size(); ++i) {
    out = put_index(out, first + i);
    out = write_scientific(out, areas[i]);
    *out++ = '\n';
  }
  text.advance_to(out);
}

}  // namespace eses::detail
