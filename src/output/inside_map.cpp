#include "output/inside_map.hpp"

#include <algorithm>
#include <utility>

#include "system/parallel.hpp"

namespace eses::detail {
namespace {

constexpr std::int64_t tile_words = 1 << 16;

// Returns the number of rows along y in a tile. A tile has the words of these rows in all planes.
std::int64_t rows_of_tile(const GridIndex& size) {
  return std::clamp<std::int64_t>(tile_words / size[2], 1, size[1]);
}

std::span<char> as_chars(std::span<std::uint64_t> words) {
  return {reinterpret_cast<char*>(words.data()), words.size_bytes()};
}

}  // namespace

// A tile has one word (64 points) along x, the rows [y_begin, y_end) along y, and all planes.
struct InsideMap::Tile {
  std::int64_t word = 0;
  std::int64_t y_begin = 0, y_end = 0;

  std::int64_t rows() const { return y_end - y_begin; }
};

InsideMap::InsideMap(MapFile file, MapFormat format, const Grid& grid, const GridRegion& region)
    : file_(std::move(file)), layout_(map_layout(format, grid, region)), size_(region.size()) {}

std::int64_t InsideMap::words_of_row(const GridIndex& size) { return (size[0] + 63) / 64; }

std::uint64_t InsideMap::bits_bytes(const GridRegion& region) {
  const GridIndex size = region.size();
  return sizeof(std::uint64_t) * static_cast<std::uint64_t>(words_of_row(size) * size[1] * size[2]);
}

std::uint64_t InsideMap::scratch_bytes(MapFormat format, const GridRegion& region) {
  return format == MapFormat::vti ? 0 : bits_bytes(region);
}

double InsideMap::thread_bytes(MapFormat format, const GridRegion& region) {
  const GridIndex size = region.size();
  const std::int64_t points = format == MapFormat::vti ? 0 : rows_of_tile(size) * size[2];
  return static_cast<double>(points) * (sizeof(std::uint64_t) + 2);
}

std::uint64_t InsideMap::word_offset(std::int64_t word, std::int64_t row) const {
  return layout_.file_bytes() +
         sizeof(std::uint64_t) * static_cast<std::uint64_t>(word * size_[1] * size_[2] + row);
}

void InsideMap::write_rows(std::int64_t first_row, std::span<const std::uint64_t> words,
                           Scratch& scratch) {
  const auto per_row = static_cast<std::size_t>(words_of_row(size_));
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
  scratch.words.resize(rows);
  for (std::size_t word = 0; word < per_row; ++word) {
    for (std::size_t row = 0; row < rows; ++row) scratch.words[row] = words[row * per_row + word];
    file_.write_at(as_chars(scratch.words),
                   word_offset(static_cast<std::int64_t>(word), first_row));
  }
}

void InsideMap::read_words(const Tile& tile, std::vector<std::uint64_t>& words) {
  words.resize(static_cast<std::size_t>(tile.rows() * size_[2]));
  if (tile.rows() == size_[1]) {
    file_.read_at(as_chars(words), word_offset(tile.word, 0));
    return;
  }
  const auto rows = static_cast<std::size_t>(tile.rows());
  for (std::int64_t z = 0; z < size_[2]; ++z)
    file_.read_at(as_chars(std::span(words).subspan(static_cast<std::size_t>(z) * rows, rows)),
                  word_offset(tile.word, z * size_[1] + tile.y_begin));
}

void InsideMap::write_tile(const Tile& tile, Scratch& scratch) {
  read_words(tile, scratch.words);
  const auto rows = static_cast<std::size_t>(tile.rows());
  const auto planes = static_cast<std::size_t>(size_[2]);
  scratch.values.resize(2 * rows * planes);
  const std::int64_t first_x = 64 * tile.word;
  for (std::int64_t x = first_x; x < std::min(first_x + 64, size_[0]); ++x) {
    const auto index = static_cast<std::uint64_t>((x * size_[1] + tile.y_begin) * size_[2]);
    fill_dx_zeros(index, scratch.values);
    char* value = scratch.values.data();
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t z = 0; z < planes; ++z, value += 2)
        *value = static_cast<char>(
            *value | static_cast<char>(scratch.words[z * rows + y] >> (x - first_x) & 1));
    file_.write_at(scratch.values, layout_.value_offset(index));
  }
}

std::int64_t InsideMap::tile_count() const {
  if (layout_.format == MapFormat::vti) return 0;
  const std::int64_t rows = rows_of_tile(size_);
  return words_of_row(size_) * ((size_[1] + rows - 1) / rows);
}

InsideMap::Tile InsideMap::tile(std::int64_t index) const {
  const std::int64_t rows = rows_of_tile(size_), per_word = (size_[1] + rows - 1) / rows;
  const std::int64_t begin = index % per_word * rows;
  return {index / per_word, begin, std::min(begin + rows, size_[1])};
}

void InsideMap::transpose_tiles(std::int64_t begin, std::int64_t end, int threads,
                                const std::function<void()>& check) {
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  parallel_for(end - begin, threads, [&](std::int64_t index, int thread) {
    check();
    write_tile(tile(begin + index), scratch[static_cast<std::size_t>(thread)]);
  });
}

void InsideMap::write_ends() {
  file_.write_at(layout_.header, 0);
  file_.write_at(layout_.footer, layout_.value_offset(layout_.points));
}

}  // namespace eses::detail
