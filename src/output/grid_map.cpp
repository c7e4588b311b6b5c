#include "output/grid_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <deque>
#include <string_view>
#include <utility>

#include "grid/inside_fraction.hpp"
#include "system/gzip.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

constexpr std::int64_t tile_words = 1 << 16;
constexpr std::int64_t cell_points = 64;

std::int64_t words_of_cell(MapQuantity quantity) {
  return is_of_edges(quantity) ? cell_points / std::int64_t{fractions_per_word} : 1;
}

std::int64_t cells_along(const GridIndex& size) {
  return (size[0] + cell_points - 1) / cell_points;
}

// Returns the number of rows along y in a tile, which is transposed at a time.
std::int64_t rows_in_tile(MapQuantity quantity, const GridIndex& size) {
  return std::clamp<std::int64_t>(tile_words / (words_of_cell(quantity) * size[2]), 1, size[1]);
}

// Bytes of members that are stored or appended at a time.
constexpr std::size_t member_buffer_bytes = 1 << 18;

// Range of a gzip member in a scratch file.
struct MemberRange {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;
};

// Fills `values` with the bytes of a .vti file, one for each bit.
void fill_vti_values(std::span<const std::uint64_t> bits, std::span<char> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<char>(bits[i / 64] >> (i % 64) & 1);
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

// The values of a tile with one x. Row y of plane z has the word `words[(z * rows + y) * stride]`.
struct GridMap::Slice {
  const std::uint64_t* words = nullptr;
  std::size_t stride = 1;
  std::size_t in_cell = 0;  // index of the value in its cell
  std::size_t rows = 0, planes = 0;
  std::uint64_t first_index = 0;  // index of the first value in the map

  std::size_t count() const { return rows * planes; }
  bool bit(std::size_t row) const { return (words[row * stride] >> in_cell & 1) != 0; }
  std::uint32_t fraction(std::size_t row) const {
    return fraction_in(words[row * stride], in_cell);
  }
};

GridMap::GridMap(MapFile file, MapChoice map, const Grid& grid, const GridRegion& region)
    : file_(std::move(file)),
      map_(std::move(map)),
      layout_(map_layout(map_, grid, region)),
      size_(region.size()) {}

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

std::uint64_t GridMap::scratch_bytes(const MapChoice& map, const GridRegion& region) {
  return map.format == MapFormat::vti ? 0 : row_bytes(map.quantity, region);
}

double GridMap::thread_bytes(const MapChoice& map, const GridRegion& region) {
  if (map.format == MapFormat::vti) return 0;
  const GridIndex size = region.size();
  const auto points = static_cast<double>(rows_in_tile(map.quantity, size) * size[2]);
  const auto words = static_cast<double>(words_of_cell(map.quantity));
  const double text = is_of_edges(map.quantity) ? dielectric_text_bytes : 2;
  const double bytes = points * (words * sizeof(std::uint64_t) + text);
  if (!map.gzip) return bytes;
  // A compressed slice, the buffer of members, and the ranges of a cell's members.
  constexpr double growth = 2;
  const double tiles = std::ceil(static_cast<double>(size[1]) /
                                 static_cast<double>(rows_in_tile(map.quantity, size)));
  return bytes + Gzip::state_bytes + points * text +
         growth * (member_buffer_bytes + points * text) + tiles * cell_points * sizeof(MemberRange);
}

std::int64_t GridMap::rows_of_tile() const { return rows_in_tile(map_.quantity, size_); }

std::int64_t GridMap::cells_of_row() const { return cells_along(size_); }

std::uint64_t GridMap::cell_offset(std::int64_t cell, std::int64_t row) const {
  return (map_.gzip ? 0 : layout_.file_bytes()) +
         sizeof(std::uint64_t) * static_cast<std::uint64_t>(words_of_cell(map_.quantity) *
                                                            (cell * size_[1] * size_[2] + row));
}

// Writes words without long runs of zeros, which the file holds where nothing is written. The last
// word of all is always written, so that the file has its full length. Most of a grid is solvent.
void GridMap::write_words(std::span<std::uint64_t> words, std::uint64_t offset) {
  constexpr std::size_t max_zeros = 512;  // a page of the page cache
  const bool is_end = offset + words.size_bytes() == cell_offset(cells_of_row(), 0);
  for (std::size_t begin = 0; begin < words.size();) {
    while (begin < words.size() && words[begin] == 0) ++begin;
    std::size_t end = begin;
    for (std::size_t next = begin; next < words.size() && next - end < max_zeros; ++next)
      if (words[next] != 0) end = next + 1;
    if (end > begin)
      file_.write_at(as_chars(words.subspan(begin, end - begin)),
                     offset + sizeof(std::uint64_t) * begin);
    begin = end;
  }
  if (is_end && words.back() == 0)
    file_.write_at(as_chars(words.last(1)), offset + words.size_bytes() - sizeof(std::uint64_t));
}

void GridMap::write_rows(std::int64_t first_row, std::span<const std::uint64_t> words,
                         Scratch& scratch) {
  const auto per_row = static_cast<std::size_t>(words_of_row(map_.quantity, size_));
  const std::size_t rows = words.size() / per_row;
  if (layout_.format == MapFormat::vti) {
    const auto points = static_cast<std::size_t>(size_[0]);
    scratch.values.resize(rows * points);
    for (std::size_t row = 0; row < rows; ++row)
      fill_vti_values(words.subspan(row * per_row, per_row),
                      std::span(scratch.values).subspan(row * points, points));
    file_.write_at(scratch.values,
                   layout_.value_offset(static_cast<std::uint64_t>(first_row * size_[0])));
    return;
  }
  const auto per_cell = static_cast<std::size_t>(words_of_cell(map_.quantity));
  scratch.words.resize(rows * per_cell);
  for (std::size_t begin = 0; begin < per_row; begin += per_cell) {
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(words.data() + row * per_row + begin, per_cell,
                  scratch.words.data() + row * per_cell);
    write_words(scratch.words, cell_offset(static_cast<std::int64_t>(begin / per_cell), first_row));
  }
}

void GridMap::read_words(const Tile& tile, std::vector<std::uint64_t>& words) {
  const std::int64_t per_cell = words_of_cell(map_.quantity);
  words.resize(static_cast<std::size_t>(tile.rows() * size_[2] * per_cell));
  if (tile.rows() == size_[1]) {
    file_.read_at(as_chars(std::span(words)), cell_offset(tile.cell, 0));
    return;
  }
  const auto row_words = static_cast<std::size_t>(tile.rows() * per_cell);
  for (std::int64_t z = 0; z < size_[2]; ++z)
    file_.read_at(
        as_chars(std::span(words).subspan(static_cast<std::size_t>(z) * row_words, row_words)),
        cell_offset(tile.cell, z * size_[1] + tile.y_begin));
}

// Calls `action(x)` for the points of a tile along x.
template <class Action>
void GridMap::for_each_x(const Tile& tile, Action&& action) const {
  const std::int64_t begin = cell_points * tile.cell;
  for (std::int64_t x = begin; x < std::min(begin + cell_points, size_[0]); ++x) action(x);
}

// Returns the values of a tile with this x, whose words are `words`.
GridMap::Slice GridMap::slice(const Tile& tile, std::int64_t x,
                              const std::vector<std::uint64_t>& words) const {
  const auto in_cell = static_cast<std::size_t>(x % cell_points);
  return {.words = words.data() + (is_of_edges(map_.quantity) ? in_cell / fractions_per_word : 0),
          .stride = static_cast<std::size_t>(words_of_cell(map_.quantity)),
          .in_cell = in_cell,
          .rows = static_cast<std::size_t>(tile.rows()),
          .planes = static_cast<std::size_t>(size_[2]),
          .first_index = static_cast<std::uint64_t>((x * size_[1] + tile.y_begin) * size_[2])};
}

void GridMap::fill_points(Slice slice, std::span<char> text) const {
  fill_dx_zeros(slice.first_index, text);
  // For ion access, the bits mark points without access.
  const bool is_inverted = map_.quantity == MapQuantity::ion_access;
  char* value = text.data();
  for (std::size_t y = 0; y < slice.rows; ++y)
    for (std::size_t z = 0; z < slice.planes; ++z, value += 2)
      *value = static_cast<char>(*value |
                                 static_cast<char>(slice.bit(z * slice.rows + y) != is_inverted));
}

void GridMap::fill_edges(Slice slice, std::span<char> text) const {
  constexpr std::size_t digits = dielectric_text_bytes - 1;
  std::array<char, digits> solvent{}, solute{};
  write_dielectric(solvent.data(), map_.solvent);
  write_dielectric(solute.data(), map_.solute);
  char* value = text.data();
  std::uint64_t column = slice.first_index % dx_values_per_line;
  for (std::size_t y = 0; y < slice.rows; ++y)
    for (std::size_t z = 0; z < slice.planes; ++z, value += dielectric_text_bytes) {
      const std::uint32_t fraction = slice.fraction(z * slice.rows + y);
      if (fraction == 0)
        std::memcpy(value, solvent.data(), digits);
      else if (fraction == whole_edge)
        std::memcpy(value, solute.data(), digits);
      else
        write_dielectric(value, dielectric_of(map_, fraction));
      const bool is_last = ++column == dx_values_per_line;
      value[digits] = is_last ? '\n' : ' ';
      if (is_last) column = 0;
    }
}

// Fills `text` with the text of the values.
void GridMap::fill_values(const Slice& slice, std::vector<char>& text) const {
  text.resize(layout_.value_bytes * slice.count());
  if (is_of_edges(map_.quantity))
    fill_edges(slice, text);
  else
    fill_points(slice, text);
}

void GridMap::write_tile(const Tile& tile, Scratch& scratch) {
  read_words(tile, scratch.words);
  for_each_x(tile, [&](std::int64_t x) {
    const Slice values = slice(tile, x, scratch.words);
    fill_values(values, scratch.values);
    file_.write_at(scratch.values, layout_.value_offset(values.first_index));
  });
}

std::int64_t GridMap::tiles_of_cell() const {
  const std::int64_t rows = rows_of_tile();
  return (size_[1] + rows - 1) / rows;
}

std::int64_t GridMap::tile_count() const {
  return layout_.format == MapFormat::vti ? 0 : cells_of_row() * tiles_of_cell();
}

GridMap::Tile GridMap::tile(std::int64_t index) const {
  const std::int64_t rows = rows_of_tile(), per_cell = tiles_of_cell();
  const std::int64_t begin = index % per_cell * rows;
  return {index / per_cell, begin, std::min(begin + rows, size_[1])};
}

void GridMap::transpose_tiles(std::int64_t begin, std::int64_t end, int threads,
                              const std::function<void()>& check) {
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  parallel_for(end - begin, threads, [&](std::int64_t index, int thread) {
    check();
    write_tile(tile(begin + index), scratch[static_cast<std::size_t>(thread)]);
  });
}

// If all values are wholly inside or all are outside, returns the fraction of such an edge or the
// bit of such a point.
std::optional<std::uint32_t> GridMap::uniform_value(Slice slice) const {
  const bool has_edges = is_of_edges(map_.quantity);
  const auto value_of = [&](std::size_t row) {
    return has_edges ? slice.fraction(row) : std::uint32_t{slice.bit(row)};
  };
  const std::uint32_t first = value_of(0);
  if (first != 0 && first != (has_edges ? whole_edge : 1)) return std::nullopt;
  for (std::size_t row = 1; row < slice.count(); ++row)
    if (value_of(row) != first) return std::nullopt;
  return first;
}

// Compresses the values of slices, each as a gzip member.
class GridMap::Compressor {
 public:
  // Keeps references to all three. Several compressors store their members in `file`, and advance
  // its end.
  Compressor(const GridMap& map, ScratchFile& file, std::atomic<std::uint64_t>& end)
      : map_(map), file_(file), end_(end) {}

  // Compresses a slice. Returns the range of its member, which is in the file after `flush`.
  MemberRange add(const Slice& slice) {
    const std::span<const char> member = compressed(slice);
    if (buffer_.size() + member.size() > reserved_) {
      flush();
      reserved_ = std::max(member_buffer_bytes, member.size());
      begin_ = end_.fetch_add(reserved_);
    }
    const std::uint64_t offset = begin_ + buffer_.size();
    buffer_.insert(buffer_.end(), member.begin(), member.end());
    return {offset, static_cast<std::uint32_t>(member.size())};
  }

  void flush() {
    file_.write_at(buffer_, begin_);
    buffer_.clear();
    reserved_ = 0;
  }

  std::vector<std::uint64_t> words;  // of the tile of the slices

 private:
  // Most slices have one value. Their members differ only in where lines end.
  struct Known {
    std::uint32_t value = 0;
    std::uint64_t phase = 0;
    std::size_t count = 0;
    std::vector<char> member;
  };

  std::span<const char> compressed(const Slice& slice) {
    const auto value = map_.uniform_value(slice);
    const std::uint64_t phase = slice.first_index % dx_values_per_line;
    if (value)
      for (const Known& known : known_)
        if (known.value == *value && known.phase == phase && known.count == slice.count())
          return known.member;
    map_.fill_values(slice, text_);
    const std::span<const char> member = gzip_.member(text_);
    if (value) known_.push_back({*value, phase, slice.count(), {member.begin(), member.end()}});
    return member;
  }

  const GridMap& map_;
  ScratchFile& file_;
  std::atomic<std::uint64_t>& end_;
  std::uint64_t begin_ = 0;   // offset of the buffer in the file
  std::size_t reserved_ = 0;  // bytes of the file for the buffer
  std::vector<char> buffer_;  // members that are not in the file yet
  std::vector<char> text_;
  Gzip gzip_;
  std::vector<Known> known_;
};

// The members of a tile are far apart in the text, so that they are stored in `members` first.
void GridMap::compress_cells(std::int64_t begin, std::int64_t end, int threads,
                             const std::function<void()>& check, ScratchFile& members,
                             ScratchFile& text) {
  std::atomic<std::uint64_t> members_end = 0;
  std::deque<Compressor> compressors;
  for (int thread = 0; thread < threads; ++thread)
    compressors.emplace_back(*this, members, members_end);
  const std::int64_t tiles = tiles_of_cell();
  // The members of a cell, in the order of the text.
  std::vector<MemberRange> ranges(static_cast<std::size_t>(tiles * cell_points));
  std::vector<char> buffer;
  const auto append = [&] {
    text.append(buffer);
    buffer.clear();
  };
  for (std::int64_t cell = begin; cell < end; ++cell) {
    members_end = 0;
    parallel_for(tiles, threads, [&](std::int64_t index, int thread) {
      check();
      Compressor& compressor = compressors[static_cast<std::size_t>(thread)];
      const Tile next = tile(cell * tiles + index);
      read_words(next, compressor.words);
      for_each_x(next, [&](std::int64_t x) {
        ranges[static_cast<std::size_t>(x % cell_points * tiles + index)] =
            compressor.add(slice(next, x, compressor.words));
      });
    });
    for (Compressor& compressor : compressors) compressor.flush();
    check();
    const std::int64_t slices = std::min(cell_points, size_[0] - cell * cell_points);
    for (const auto& [offset, bytes] :
         std::span(ranges).first(static_cast<std::size_t>(tiles * slices))) {
      const std::size_t old = buffer.size();
      buffer.resize(old + bytes);
      members.read_at(std::span(buffer).subspan(old), offset);
      if (buffer.size() >= member_buffer_bytes) append();
    }
  }
  append();
}

void GridMap::write_ends() {
  file_.write_at(layout_.header, 0);
  file_.write_at(layout_.footer, layout_.value_offset(layout_.points));
}

}  // namespace eses::detail
