#include "output/grid_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "grid/inside_fraction.hpp"
#include "system/gzip.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// 64 points along x make a cell, which has one bit for each point, or 32 words with the fractions
// of its edges.
constexpr std::int64_t cell_points = 64;

std::int64_t words_of_cell(MapQuantity quantity) {
  return is_of_edges(quantity) ? cell_points / std::int64_t{fractions_per_word} : 1;
}

std::int64_t cells_along(const GridIndex& size) {
  return (size[0] + cell_points - 1) / cell_points;
}

// Returns the number of rows along y in a tile. The members of a compressed map end with tiles, so
// that its bytes depend on this number.
std::int64_t rows_in_tile(MapQuantity quantity, const GridIndex& size) {
  constexpr std::int64_t tile_words = 1 << 16;
  return std::clamp<std::int64_t>(tile_words / (words_of_cell(quantity) * size[2]), 1, size[1]);
}

// Fills `text` with the text of zero values of a .dx file, two bytes a value, starting with value
// number `first_index`. Setting bit 0 of the first byte of a value makes it 1.
void fill_dx_zeros(std::uint64_t first_index, std::span<char> text) {
  constexpr std::string_view line = "0 0 0\n";
  static_assert(line.size() == 2 * dx_values_per_line);
  const std::size_t skipped = 2 * static_cast<std::size_t>(first_index % dx_values_per_line);
  const std::size_t start = std::min(text.size(), line.size() - skipped);
  std::memcpy(text.data(), line.data() + skipped, start);
  // Each copy doubles the number of complete lines.
  std::span<char> lines = text.subspan(start);
  std::size_t filled = std::min(lines.size(), line.size());
  std::memcpy(lines.data(), line.data(), filled);
  while (filled < lines.size()) {
    const std::size_t count = std::min(filled, lines.size() - filled);
    std::memcpy(lines.data() + filled, lines.data(), count);
    filled += count;
  }
}

// Writes the text of an edge's value without its separator.
void write_dielectric(char* text, double value) { fmt::format_to(text, "{:.6e}", value); }

}  // namespace

// A tile: the points of one cell along x, of some rows along y, and of all planes.
struct GridMap::Tile {
  std::int64_t cell = 0;
  std::int64_t y_begin = 0, y_end = 0;

  std::int64_t rows() const { return y_end - y_begin; }
};

// The values of a tile with one x, which are consecutive in a .dx file. Row y of plane z has the
// word `words[z * rows + y]`.
struct GridMap::Slice {
  std::span<const std::uint64_t> words;
  std::size_t in_cell = 0;  // index of the values in their cell
  std::size_t rows = 0, planes = 0;
  std::uint64_t first_index = 0;  // index of the first value in the map
  std::deque<PartialEdge>::const_iterator partial_begin, partial_end;

  std::size_t count() const { return rows * planes; }
  bool bit(std::size_t row) const { return (words[row] >> in_cell & 1) != 0; }
  // Calls `action(bit)` for the values in the order of a .dx file.
  template <class Action>
  void for_each(Action&& action) const {
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t z = 0; z < planes; ++z) action(bit(z * rows + y));
  }
  // If all points or edges are wholly inside or all are outside, returns their bit.
  std::optional<bool> uniform_bit() const {
    if (partial_begin != partial_end) return std::nullopt;
    for (std::size_t row = 1; row < count(); ++row)
      if (bit(row) != bit(0)) return std::nullopt;
    return bit(0);
  }
};

GridMap::GridMap(MapChoice map, const Grid& grid, const GridRegion& region)
    : map_(std::move(map)),
      layout_(map_layout(map_, grid, region)),
      size_(region.size()),
      bits_(static_cast<std::size_t>(cells_along(size_) * size_[1] * size_[2])) {}

std::int64_t GridMap::words_of_row(MapQuantity quantity, const GridIndex& size) {
  return words_of_cell(quantity) * cells_along(size);
}

std::uint64_t GridMap::row_bytes(MapQuantity quantity, const GridRegion& region) {
  const GridIndex size = region.size();
  return sizeof(std::uint64_t) *
         static_cast<std::uint64_t>(words_of_row(quantity, size) * size[1] * size[2]);
}

std::uint64_t GridMap::typical_compressed_bytes(const MapChoice& map, const GridRegion& region,
                                                double crossings) {
  // Measured with proteins and rounded up: bytes of the header, of a value and of a crossing.
  constexpr double header = 600;
  const auto points = static_cast<double>(region.point_count());
  return static_cast<std::uint64_t>(header + (is_of_edges(map.quantity)
                                                  ? 0.2 * points + 5 * crossings
                                                  : 0.015 * points + 1.5 * crossings));
}

double GridMap::memory_bytes(const MapChoice& map, const GridRegion& region, double crossings) {
  // Each crossing is on an edge of one of three maps.
  return static_cast<double>(row_bytes(MapQuantity::inside, region)) +
         (is_of_edges(map.quantity) ? sizeof(PartialEdge) * crossings / 3 : 0);
}

double GridMap::thread_bytes(const MapChoice& map, const GridRegion& region) {
  const GridIndex size = region.size();
  if (map.format == MapFormat::vti) return static_cast<double>(size[0] * size[1]);
  const auto points = static_cast<double>(rows_in_tile(map.quantity, size) * size[2]);
  const double text = is_of_edges(map.quantity) ? dielectric_text_bytes : 2;
  const double bytes = points * (sizeof(std::uint64_t) + text);
  if (!map.gzip) return bytes;
  // Compressed slices of a tile, of which most are short, and those with a single value.
  constexpr double slices = 8;
  return bytes + Gzip::state_bytes + slices * points * text;
}

// Returns the index in a .dx file of value `x` of a row.
std::uint64_t GridMap::dx_index(std::int64_t x, std::int64_t row) const {
  const std::int64_t y = row % size_[1], z = row / size_[1];
  return static_cast<std::uint64_t>((x * size_[1] + y) * size_[2] + z);
}

void GridMap::add_rows(std::int64_t first_row, std::span<const std::uint64_t> words) {
  const auto rows = static_cast<std::size_t>(size_[1] * size_[2]);
  const auto cells = static_cast<std::size_t>(cells_along(size_));
  std::vector<PartialEdge> partial;
  std::size_t next = 0;
  for (std::int64_t row = first_row; next < words.size(); ++row)
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::uint64_t& bits = bits_[cell * rows + static_cast<std::size_t>(row)];
      if (!is_of_edges(map_.quantity)) {
        bits = words[next++];
        continue;
      }
      const std::int64_t x = static_cast<std::int64_t>(cell) * cell_points;
      const std::int64_t count = std::min(cell_points, size_[0] - x);
      for (std::int64_t i = 0; i < count; ++i) {
        const auto edge = static_cast<std::size_t>(i);
        const std::uint32_t fraction = fraction_in(words[next + edge / fractions_per_word], edge);
        if (fraction == whole_edge)
          bits |= std::uint64_t{1} << edge;
        else if (fraction != 0)
          partial.push_back({dx_index(x + i, row), fraction});
      }
      next += static_cast<std::size_t>(words_of_cell(map_.quantity));
    }
  const std::lock_guard lock(mutex_);
  partial_edges_.insert(partial_edges_.end(), partial.begin(), partial.end());
}

std::int64_t GridMap::tiles_of_cell() const {
  const std::int64_t rows = rows_in_tile(map_.quantity, size_);
  return (size_[1] + rows - 1) / rows;
}

GridMap::Tile GridMap::tile(std::int64_t index) const {
  const std::int64_t rows = rows_in_tile(map_.quantity, size_), per_cell = tiles_of_cell();
  const std::int64_t begin = index % per_cell * rows;
  return {index / per_cell, begin, std::min(begin + rows, size_[1])};
}

std::vector<std::uint64_t> GridMap::words_of(const Tile& tile) const {
  std::vector<std::uint64_t> words;
  words.reserve(static_cast<std::size_t>(tile.rows() * size_[2]));
  for (std::int64_t z = 0; z < size_[2]; ++z) {
    const auto row = bits_.begin() + (tile.cell * size_[2] + z) * size_[1];
    words.insert(words.end(), row + tile.y_begin, row + tile.y_end);
  }
  return words;
}

// Calls `action(x)` for the points of a tile along x.
template <class Action>
void GridMap::for_each_x(const Tile& tile, Action&& action) const {
  const std::int64_t begin = cell_points * tile.cell;
  for (std::int64_t x = begin; x < std::min(begin + cell_points, size_[0]); ++x) action(x);
}

// Returns the values of a tile with this x, whose words are `words`.
GridMap::Slice GridMap::slice(const Tile& tile, std::int64_t x,
                              std::span<const std::uint64_t> words) const {
  const std::uint64_t first = dx_index(x, tile.y_begin);
  const auto at = [&](std::uint64_t index) {
    return std::ranges::lower_bound(partial_edges_, index, {}, &PartialEdge::index);
  };
  return {.words = words,
          .in_cell = static_cast<std::size_t>(x % cell_points),
          .rows = static_cast<std::size_t>(tile.rows()),
          .planes = static_cast<std::size_t>(size_[2]),
          .first_index = first,
          .partial_begin = at(first),
          .partial_end = at(first + words.size())};
}

void GridMap::fill_points(const Slice& slice, std::span<char> text) const {
  fill_dx_zeros(slice.first_index, text);
  // For ion access, the bits mark points without access.
  const bool is_inverted = map_.quantity == MapQuantity::ion_access;
  char* value = text.data();
  slice.for_each([&](bool bit) {
    *value = static_cast<char>(*value | static_cast<char>(bit != is_inverted));
    value += 2;
  });
}

void GridMap::fill_edges(const Slice& slice, std::span<char> text) const {
  constexpr std::size_t digits = dielectric_text_bytes - 1;
  std::array<char, digits> solvent{}, solute{};
  write_dielectric(solvent.data(), map_.solvent);
  write_dielectric(solute.data(), map_.solute);
  char* value = text.data();
  std::uint64_t column = slice.first_index % dx_values_per_line;
  slice.for_each([&](bool bit) {
    std::memcpy(value, (bit ? solute : solvent).data(), digits);
    const bool is_last = ++column == dx_values_per_line;
    value[digits] = is_last ? '\n' : ' ';
    if (is_last) column = 0;
    value += dielectric_text_bytes;
  });
  for (auto edge = slice.partial_begin; edge != slice.partial_end; ++edge)
    write_dielectric(text.data() + (edge->index - slice.first_index) * dielectric_text_bytes,
                     dielectric_of(map_, edge->fraction));
}

// Fills `text` with the text of the values.
void GridMap::fill_values(const Slice& slice, std::vector<char>& text) const {
  text.resize(layout_.value_bytes * slice.count());
  if (is_of_edges(map_.quantity))
    fill_edges(slice, text);
  else
    fill_points(slice, text);
}

std::uint64_t GridMap::write(OutputFile& file, int threads, const std::function<void()>& check) {
  std::ranges::sort(partial_edges_, {}, &PartialEdge::index);
  if (map_.gzip) {
    append_members(file, threads, check);
    return file.size();
  }
  file.write_at(layout_.header, 0);
  if (layout_.format == MapFormat::vti)
    write_planes(file, threads, check);
  else
    write_tiles(file, threads, check);
  file.write_at(layout_.footer, layout_.value_offset(layout_.points));
  return layout_.file_bytes();
}

// Writes the values of a .dx file.
void GridMap::write_tiles(OutputFile& file, int threads, const std::function<void()>& check) const {
  std::vector<std::vector<char>> texts(static_cast<std::size_t>(threads));
  parallel_for(cells_along(size_) * tiles_of_cell(), threads, [&](std::int64_t index, int thread) {
    check();
    std::vector<char>& text = texts[static_cast<std::size_t>(thread)];
    const Tile next = tile(index);
    const std::vector<std::uint64_t> words = words_of(next);
    for_each_x(next, [&](std::int64_t x) {
      const Slice values = slice(next, x, words);
      fill_values(values, text);
      file.write_at(text, layout_.value_offset(values.first_index));
    });
  });
}

// Writes the values of a .vti file.
void GridMap::write_planes(OutputFile& file, int threads,
                           const std::function<void()>& check) const {
  parallel_for(size_[2], threads, [&](std::int64_t z, int) {
    check();
    std::vector<char> values;
    values.reserve(static_cast<std::size_t>(size_[0] * size_[1]));
    for (std::int64_t y = 0; y < size_[1]; ++y)
      for (std::int64_t begin = 0; begin < size_[0]; begin += cell_points) {
        const std::int64_t word = (begin / cell_points * size_[2] + z) * size_[1] + y;
        std::uint64_t bits = bits_[static_cast<std::size_t>(word)];
        for (std::int64_t x = begin; x < std::min(begin + cell_points, size_[0]); ++x, bits >>= 1)
          values.push_back(static_cast<char>(bits & 1));
      }
    file.write_at(values,
                  layout_.value_offset(static_cast<std::uint64_t>(z * size_[0] * size_[1])));
  });
}

// Compresses the values of slices, each as a gzip member.
class GridMap::Compressor {
 public:
  // Keeps a reference to the map.
  explicit Compressor(const GridMap& map) : map_(map) {}

  std::vector<char> member_of(const Slice& slice) {
    const std::optional<bool> bit = slice.uniform_bit();
    const std::uint64_t phase = slice.first_index % dx_values_per_line;
    if (bit)
      for (const Known& known : known_)
        if (known.bit == *bit && known.phase == phase && known.count == slice.count())
          return known.member;
    map_.fill_values(slice, text_);
    const std::span<const char> bytes = gzip_.member(text_);
    std::vector<char> member(bytes.begin(), bytes.end());
    if (bit) known_.push_back({*bit, phase, slice.count(), member});
    return member;
  }

 private:
  // Most slices have one value. Their members differ only in where lines end.
  struct Known {
    bool bit = false;
    std::uint64_t phase = 0;
    std::size_t count = 0;
    std::vector<char> member;
  };

  const GridMap& map_;
  std::vector<char> text_;
  Gzip gzip_;
  std::vector<Known> known_;
};

// Appends a compressed .dx file. The members of a tile are not consecutive in the text, so that
// those of a cell are made before they are appended.
void GridMap::append_members(OutputFile& file, int threads,
                             const std::function<void()>& check) const {
  std::deque<Compressor> compressors;
  for (int thread = 0; thread < threads; ++thread) compressors.emplace_back(*this);
  file.append(Gzip().member(layout_.header));
  const std::int64_t tiles = tiles_of_cell();
  // The members of a cell, in the order of the text.
  std::vector<std::vector<char>> members(static_cast<std::size_t>(tiles * cell_points));
  std::vector<char> text;
  for (std::int64_t cell = 0; cell < cells_along(size_); ++cell) {
    parallel_for(tiles, threads, [&](std::int64_t index, int thread) {
      check();
      const Tile next = tile(cell * tiles + index);
      const std::vector<std::uint64_t> words = words_of(next);
      for_each_x(next, [&](std::int64_t x) {
        members[static_cast<std::size_t>(x % cell_points * tiles + index)] =
            compressors[static_cast<std::size_t>(thread)].member_of(slice(next, x, words));
      });
    });
    check();
    text.clear();
    for (std::vector<char>& member : members) {
      text.insert(text.end(), member.begin(), member.end());
      member = {};
    }
    file.append(text);
  }
  file.append(Gzip().member(layout_.footer));
}

}  // namespace eses::detail
