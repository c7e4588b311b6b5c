#include "output/grid_map.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
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

// Bytes of members that a thread stores at a time.
constexpr std::size_t member_buffer_bytes = 1 << 18;

// Range of a gzip member in a scratch file.
struct MemberRange {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;
};

std::vector<char> compressed_text(std::string_view text) {
  Gzip gzip;
  const std::span<const char> member = gzip.member(text);
  return {member.begin(), member.end()};
}

}  // namespace

// A tile: the points of one cell along x, of some rows along y, and of all planes.
struct GridMap::Tile {
  std::int64_t cell = 0;
  std::int64_t y_begin = 0, y_end = 0;

  std::int64_t rows() const { return y_end - y_begin; }
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
  // The compressed plane of a tile, the buffer of members, and the ranges of a cell's members.
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

// Writes the values of all points of the tile with this x.
void GridMap::fill_points(const Tile& tile, std::int64_t x, std::uint64_t first_index,
                          Scratch& scratch) const {
  const auto rows = static_cast<std::size_t>(tile.rows());
  const auto planes = static_cast<std::size_t>(size_[2]);
  scratch.values.resize(2 * rows * planes);
  fill_dx_zeros(first_index, scratch.values);
  const auto shift = static_cast<int>(x % cell_points);
  // For ion access, the bits mark points without access.
  const unsigned inverted = map_.quantity == MapQuantity::ion_access ? 1 : 0;
  char* value = scratch.values.data();
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t z = 0; z < planes; ++z, value += 2)
      *value = static_cast<char>(
          *value | static_cast<char>((scratch.words[z * rows + y] >> shift & 1) ^ inverted));
}

// Writes the values of all edges of the tile whose lower ends have this x.
void GridMap::fill_edges(const Tile& tile, std::int64_t x, std::uint64_t first_index,
                         Scratch& scratch) const {
  constexpr std::size_t digits = dielectric_text_bytes - 1;
  const auto rows = static_cast<std::size_t>(tile.rows());
  const auto planes = static_cast<std::size_t>(size_[2]);
  scratch.values.resize(dielectric_text_bytes * rows * planes);
  std::array<char, digits> solvent{}, solute{};
  write_dielectric(solvent.data(), map_.solvent);
  write_dielectric(solute.data(), map_.solute);
  const auto in_cell = static_cast<std::size_t>(x % cell_points);
  const auto per_cell = static_cast<std::size_t>(words_of_cell(map_.quantity));
  const std::uint64_t* const words = scratch.words.data() + in_cell / fractions_per_word;
  char* value = scratch.values.data();
  std::uint64_t index = first_index % 3;  // sufficient for dx_separator()
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t z = 0; z < planes; ++z, value += dielectric_text_bytes) {
      const std::uint32_t fraction = fraction_in(words[(z * rows + y) * per_cell], in_cell);
      if (fraction == 0)
        std::memcpy(value, solvent.data(), digits);
      else if (fraction == whole_edge)
        std::memcpy(value, solute.data(), digits);
      else
        write_dielectric(value, dielectric_of(map_, fraction));
      value[digits] = dx_separator(index);
      index = index == 2 ? 0 : index + 1;
    }
}

// Index of the first value with this x.
std::uint64_t GridMap::first_index(const Tile& tile, std::int64_t x) const {
  return static_cast<std::uint64_t>((x * size_[1] + tile.y_begin) * size_[2]);
}

void GridMap::fill_values(const Tile& tile, std::int64_t x, Scratch& scratch) const {
  if (is_of_edges(map_.quantity))
    fill_edges(tile, x, first_index(tile, x), scratch);
  else
    fill_points(tile, x, first_index(tile, x), scratch);
}

void GridMap::write_tile(const Tile& tile, Scratch& scratch) {
  read_words(tile, scratch.words);
  const std::int64_t first_x = cell_points * tile.cell;
  for (std::int64_t x = first_x; x < std::min(first_x + cell_points, size_[0]); ++x) {
    fill_values(tile, x, scratch);
    file_.write_at(scratch.values, layout_.value_offset(first_index(tile, x)));
  }
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

// If all values with this x are the same, returns the fraction of such an edge or the bit of such a
// point.
std::optional<std::uint32_t> GridMap::uniform_value(const Tile& tile, std::int64_t x,
                                                    const Scratch& scratch) const {
  const auto in_cell = static_cast<std::size_t>(x % cell_points);
  const bool has_edges = is_of_edges(map_.quantity);
  const auto per_cell = static_cast<std::size_t>(words_of_cell(map_.quantity));
  const std::size_t first_word = has_edges ? in_cell / fractions_per_word : 0;
  const auto count = static_cast<std::size_t>(tile.rows() * size_[2]);
  const auto value_of = [&](std::size_t row) {
    const std::uint64_t word = scratch.words[row * per_cell + first_word];
    return has_edges ? fraction_in(word, in_cell) : static_cast<std::uint32_t>(word >> in_cell & 1);
  };
  const std::uint32_t first = value_of(0);
  const bool is_whole = first == 0 || first == (has_edges ? whole_edge : 1);
  if (!is_whole) return std::nullopt;
  for (std::size_t row = 1; row < count; ++row)
    if (value_of(row) != first) return std::nullopt;
  return first;
}

// Compresses the values of tiles, each plane of x as a gzip member.
class GridMap::Compressor {
 public:
  // Keeps references to all three. Several compressors use `end`, the end of the scratch file.
  Compressor(const GridMap& map, ScratchFile& file, std::atomic<std::uint64_t>& end)
      : map_(map), file_(file), end_(end) {}

  // Words of the tile that is compressed next.
  Scratch& scratch() { return scratch_; }

  // Compresses a tile and stores the members, whose ranges go to every `stride`th of `ranges`.
  void add(const Tile& tile, std::span<MemberRange> ranges, std::size_t stride) {
    const std::int64_t first_x = cell_points * tile.cell;
    const std::int64_t end_x = std::min(first_x + cell_points, map_.size_[0]);
    stored_ = 0;
    for (std::int64_t x = first_x; x < end_x; ++x) {
      const std::span<const char> member = compressed(tile, x);
      buffer_.insert(buffer_.end(), member.begin(), member.end());
      const auto plane = static_cast<std::size_t>(x - first_x);
      sizes_[plane] = static_cast<std::uint32_t>(member.size());
      if (buffer_.size() >= member_buffer_bytes || x + 1 == end_x) store(plane + 1, ranges, stride);
    }
  }

 private:
  // Most planes have one value. Their members differ only in where lines end.
  struct Known {
    std::uint32_t value = 0;
    std::uint64_t phase = 0;
    std::int64_t rows = 0;
    std::vector<char> bytes;
  };

  std::span<const char> compressed(const Tile& tile, std::int64_t x) {
    const auto value = map_.uniform_value(tile, x, scratch_);
    const std::uint64_t phase = map_.first_index(tile, x) % 3;
    if (value)
      for (const Known& known : known_)
        if (known.value == *value && known.phase == phase && known.rows == tile.rows())
          return known.bytes;
    map_.fill_values(tile, x, scratch_);
    const std::span<const char> member = gzip_.member(scratch_.values);
    if (value)
      known_.push_back({*value, phase, tile.rows(), std::vector(member.begin(), member.end())});
    return member;
  }

  // Stores the members of the planes before `plane_end` that are in the buffer.
  void store(std::size_t plane_end, std::span<MemberRange> ranges, std::size_t stride) {
    std::uint64_t offset = end_.fetch_add(buffer_.size());
    file_.write_at(buffer_, offset);
    for (; stored_ < plane_end; ++stored_) {
      ranges[stored_ * stride] = {offset, sizes_[stored_]};
      offset += sizes_[stored_];
    }
    buffer_.clear();
  }

  const GridMap& map_;
  ScratchFile& file_;
  std::atomic<std::uint64_t>& end_;
  Gzip gzip_;
  Scratch scratch_;
  std::vector<char> buffer_;  // members that are not stored yet
  std::array<std::uint32_t, cell_points> sizes_{};
  std::size_t stored_ = 0;  // planes of the tile whose members are stored
  std::vector<Known> known_;
};

void GridMap::compress_cells(std::int64_t begin, std::int64_t end, int threads,
                             const std::function<void()>& check, ScratchFile& members,
                             ScratchFile& text) {
  std::atomic<std::uint64_t> members_end = 0;
  std::vector<std::unique_ptr<Compressor>> compressors;
  compressors.reserve(static_cast<std::size_t>(threads));
  for (int thread = 0; thread < threads; ++thread)
    compressors.push_back(std::make_unique<Compressor>(*this, members, members_end));
  const std::int64_t per_cell = tiles_of_cell();
  const auto stride = static_cast<std::size_t>(per_cell);
  std::vector<MemberRange> ranges(stride * cell_points);
  std::vector<char> buffer;
  const auto append = [&] {
    text.append(buffer);
    buffer.clear();
  };
  for (std::int64_t cell = begin; cell < end; ++cell) {
    members_end = 0;
    parallel_for(per_cell, threads, [&](std::int64_t index, int thread) {
      check();
      Compressor& compressor = *compressors[static_cast<std::size_t>(thread)];
      const Tile next = tile(cell * per_cell + index);
      read_words(next, compressor.scratch().words);
      compressor.add(next, std::span(ranges).subspan(static_cast<std::size_t>(index)), stride);
    });
    check();
    const std::int64_t planes = std::min(cell_points, size_[0] - cell * cell_points);
    for (const MemberRange& member :
         std::span(ranges).first(stride * static_cast<std::size_t>(planes))) {
      const std::size_t old = buffer.size();
      buffer.resize(old + member.bytes);
      members.read_at(std::span(buffer).subspan(old), member.offset);
      if (buffer.size() >= member_buffer_bytes) append();
    }
  }
  append();
}

std::vector<char> GridMap::compressed_header() const { return compressed_text(layout_.header); }

std::vector<char> GridMap::compressed_footer() const { return compressed_text(layout_.footer); }

void GridMap::write_ends() {
  file_.write_at(layout_.header, 0);
  file_.write_at(layout_.footer, layout_.value_offset(layout_.points));
}

}  // namespace eses::detail
