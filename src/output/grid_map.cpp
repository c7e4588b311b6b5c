#include "output/grid_map.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "system/parallel.hpp"

namespace eses::detail {
namespace {

constexpr std::int64_t tile_words = 1 << 16;
constexpr std::int64_t cell_points = 64;

std::int64_t words_of_cell(MapQuantity quantity) { return is_of_edges(quantity) ? 32 : 1; }

std::int64_t cells_along(const GridIndex& size) {
  return (size[0] + cell_points - 1) / cell_points;
}

// Returns the number of rows along y in a tile, which is transposed at a time.
std::int64_t rows_in_tile(MapQuantity quantity, const GridIndex& size) {
  return std::clamp<std::int64_t>(tile_words / (words_of_cell(quantity) * size[2]), 1, size[1]);
}

std::span<char> as_chars(std::span<std::uint64_t> words) {
  return {reinterpret_cast<char*>(words.data()), words.size_bytes()};
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

std::uint64_t GridMap::scratch_bytes(const MapChoice& map, const GridRegion& region) {
  return map.format == MapFormat::vti ? 0 : row_bytes(map.quantity, region);
}

double GridMap::thread_bytes(const MapChoice& map, const GridRegion& region) {
  if (map.format == MapFormat::vti) return 0;
  const GridIndex size = region.size();
  const auto points = static_cast<double>(rows_in_tile(map.quantity, size) * size[2]);
  const auto words = static_cast<double>(words_of_cell(map.quantity));
  const double text = is_of_edges(map.quantity) ? dielectric_text_bytes : 2;
  return points * (words * sizeof(std::uint64_t) + text);
}

std::int64_t GridMap::rows_of_tile() const { return rows_in_tile(map_.quantity, size_); }

std::int64_t GridMap::cells_of_row() const { return cells_along(size_); }

std::uint64_t GridMap::cell_offset(std::int64_t cell, std::int64_t row) const {
  return layout_.file_bytes() +
         sizeof(std::uint64_t) * static_cast<std::uint64_t>(words_of_cell(map_.quantity) *
                                                            (cell * size_[1] * size_[2] + row));
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
    file_.write_at(as_chars(scratch.words),
                   cell_offset(static_cast<std::int64_t>(begin / per_cell), first_row));
  }
}

void GridMap::read_words(const Tile& tile, std::vector<std::uint64_t>& words) {
  const std::int64_t per_cell = words_of_cell(map_.quantity);
  words.resize(static_cast<std::size_t>(tile.rows() * size_[2] * per_cell));
  if (tile.rows() == size_[1]) {
    file_.read_at(as_chars(words), cell_offset(tile.cell, 0));
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
  const std::uint64_t* const words = scratch.words.data() + in_cell / 2;
  const int shift = in_cell % 2 == 0 ? 0 : 32;
  char* value = scratch.values.data();
  std::uint64_t index = first_index % 3;  // sufficient for dx_separator()
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t z = 0; z < planes; ++z, value += dielectric_text_bytes) {
      const auto share = static_cast<std::uint32_t>(words[(z * rows + y) * per_cell] >> shift);
      if (share == 0)
        std::memcpy(value, solvent.data(), digits);
      else if (share == whole_edge)
        std::memcpy(value, solute.data(), digits);
      else
        write_dielectric(value, dielectric_of(map_, share));
      value[digits] = dx_separator(index);
      index = index == 2 ? 0 : index + 1;
    }
}

void GridMap::write_tile(const Tile& tile, Scratch& scratch) {
  read_words(tile, scratch.words);
  const std::int64_t first_x = cell_points * tile.cell;
  for (std::int64_t x = first_x; x < std::min(first_x + cell_points, size_[0]); ++x) {
    const auto index = static_cast<std::uint64_t>((x * size_[1] + tile.y_begin) * size_[2]);
    if (is_of_edges(map_.quantity))
      fill_edges(tile, x, index, scratch);
    else
      fill_points(tile, x, index, scratch);
    file_.write_at(scratch.values, layout_.value_offset(index));
  }
}

std::int64_t GridMap::tile_count() const {
  if (layout_.format == MapFormat::vti) return 0;
  const std::int64_t rows = rows_of_tile();
  return cells_of_row() * ((size_[1] + rows - 1) / rows);
}

GridMap::Tile GridMap::tile(std::int64_t index) const {
  const std::int64_t rows = rows_of_tile(), per_cell = (size_[1] + rows - 1) / rows;
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

void GridMap::write_ends() {
  file_.write_at(layout_.header, 0);
  file_.write_at(layout_.footer, layout_.value_offset(layout_.points));
}

}  // namespace eses::detail
