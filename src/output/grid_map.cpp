#include "output/grid_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "grid/map_rows.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/monitor.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

// 64 points or edges along x make a cell, whose bits are a word.
constexpr std::int64_t cell_points = 64;

std::int64_t cells_along(const GridIndex& size) {
  return (size[0] + cell_points - 1) / cell_points;
}

// Returns the texts of the values of points or whole edges whose bit is 0 and 1.
std::array<std::string, 2> value_texts(const MapChoice& map) {
  if (is_of_edges(map.quantity))
    return {formatted("{:.6e}", map.solvent), formatted("{:.6e}", map.solute)};
  // For ion access, the bits mark points without access.
  if (map.quantity == MapQuantity::ion_access) return {"1", "0"};
  return {"0", "1"};
}

// Returns the number of rows along y in a slice. The members of a compressed map end with slices,
// so that its bytes depend on this number.
std::int64_t rows_in_slice(const GridIndex& size) {
  constexpr std::int64_t max_points = 1 << 13;
  return std::clamp<std::int64_t>(max_points / size[2], 1, size[1]);
}

}  // namespace

// Consecutive values of a .dx file: those with one x, of some rows along y, and of all planes.
struct GridMap::Slice {
  std::int64_t x = 0, y_begin = 0, y_end = 0;
};

GridMap::GridMap(MapChoice map, SurfaceKind surface, const Grid& grid, const GridRegion& region)
    : map_(std::move(map)),
      layout_(map_layout(map_, surface, grid, region)),
      size_(region.size()),
      texts_(value_texts(map_)),
      bits_(static_cast<std::size_t>(cells_along(size_) * size_[1] * size_[2])) {}

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
  const GridIndex size = region.size();
  return sizeof(std::uint64_t) * static_cast<double>(cells_along(size) * size[1] * size[2]) +
         (is_of_edges(map.quantity) ? sizeof(DxEdge) * crossings / 3 : 0);
}

double GridMap::thread_bytes(const MapChoice& map, const GridRegion& region) {
  const GridIndex size = region.size();
  if (map.format == MapFormat::vti) return static_cast<double>(size[0] * size[1]);
  const double text = static_cast<double>(rows_in_slice(size) * size[2]) *
                      (is_of_edges(map.quantity) ? dielectric_text_bytes : 2);
  return map.gzip ? Gzip::state_bytes + 2 * text : text;
}

// Returns the index in a .dx file of value `x` of a row.
std::uint64_t GridMap::dx_index(std::int64_t x, std::int64_t row) const {
  const std::int64_t y = row % size_[1], z = row / size_[1];
  return static_cast<std::uint64_t>((x * size_[1] + y) * size_[2] + z);
}

void GridMap::add_rows(std::int64_t first_row, const MapRows& rows) {
  const auto all_rows = static_cast<std::size_t>(size_[1] * size_[2]);
  const auto cells = static_cast<std::size_t>(cells_along(size_));
  for (std::size_t word = 0; word < rows.bits.size(); ++word)
    bits_[word % cells * all_rows + static_cast<std::size_t>(first_row) + word / cells] =
        rows.bits[word];
  const std::lock_guard lock(mutex_);
  for (const auto& [row, x, fraction] : rows.partial_edges)
    partial_edges_.push_back({dx_index(x, first_row + row), fraction});
}

// Fills `text` with the values of a slice.
template <std::size_t digits>
void GridMap::fill_slice(const Slice& slice, std::vector<char>& text) const {
  const auto begin = static_cast<std::uint64_t>((slice.x * size_[1] + slice.y_begin) * size_[2]);
  const auto count = static_cast<std::uint64_t>((slice.y_end - slice.y_begin) * size_[2]);
  text.resize(count * (digits + 1));
  const auto word = static_cast<std::size_t>(slice.x / cell_points * size_[1] * size_[2]);
  const auto bit = static_cast<std::size_t>(slice.x % cell_points);
  char* value = text.data();
  std::uint64_t column = begin % dx_values_per_line;
  for (std::int64_t y = slice.y_begin; y < slice.y_end; ++y)
    for (std::int64_t z = 0; z < size_[2]; ++z, value += digits + 1) {
      const std::uint64_t bits = bits_[word + static_cast<std::size_t>(z * size_[1] + y)];
      std::memcpy(value, texts_[bits >> bit & 1].data(), digits);
      const bool is_last = ++column == dx_values_per_line;
      value[digits] = is_last ? '\n' : ' ';
      if (is_last) column = 0;
    }
  for (auto edge = std::ranges::lower_bound(partial_edges_, begin, {}, &DxEdge::index);
       edge != partial_edges_.end() && edge->index < begin + count; ++edge)
    fmt::format_to(text.data() + (edge->index - begin) * (digits + 1), "{:.6e}",
                   dielectric_of(map_, edge->fraction));
}

// Fills `bytes` with the values of a plane of a .vti file.
void GridMap::fill_plane(std::int64_t z, std::vector<char>& bytes) const {
  bytes.clear();
  for (std::int64_t y = 0; y < size_[1]; ++y)
    for (std::int64_t begin = 0; begin < size_[0]; begin += cell_points) {
      const std::int64_t word = (begin / cell_points * size_[2] + z) * size_[1] + y;
      std::uint64_t bits = bits_[static_cast<std::size_t>(word)];
      for (std::int64_t x = begin; x < std::min(begin + cell_points, size_[0]); ++x, bits >>= 1)
        bytes.push_back(static_cast<char>(bits & 1));
    }
}

void GridMap::write(OutputFile& file, int threads, const std::function<void()>& check) {
  std::ranges::sort(partial_edges_, {}, &DxEdge::index);
  struct Scratch {
    std::vector<char> text;
    std::optional<Gzip> gzip;
  };
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  if (map_.gzip)
    for (Scratch& of_thread : scratch) of_thread.gzip.emplace();
  const auto on_disk = [](std::span<const char> text, std::optional<Gzip>& gzip) {
    return gzip ? gzip->member(text) : text;
  };
  const bool has_planes = map_.format == MapFormat::vti;
  const std::int64_t rows = rows_in_slice(size_), slices_of_x = (size_[1] + rows - 1) / rows;
  Monitor monitor;
  std::int64_t appended = 0;
  const auto write_part = [&](std::int64_t index, int thread) {
    check();
    auto& [text, gzip] = scratch[static_cast<std::size_t>(thread)];
    const std::int64_t y = index % slices_of_x * rows;
    const Slice slice{index / slices_of_x, y, std::min(y + rows, size_[1])};
    if (has_planes)
      fill_plane(index, text);
    else if (is_of_edges(map_.quantity))
      fill_slice<dielectric_text_bytes - 1>(slice, text);
    else
      fill_slice<1>(slice, text);
    const std::span<const char> bytes = on_disk(text, gzip);
    monitor.wait_until([&] { return appended == index; });
    file.append(bytes);
    monitor.change([&] { ++appended; });
  };
  file.append(on_disk(layout_.header, scratch.front().gzip));
  parallel_for(has_planes ? size_[2] : size_[0] * slices_of_x, threads, write_part, &monitor);
  file.append(on_disk(layout_.footer, scratch.front().gzip));
}

}  // namespace eses::detail
