#include "output/grid_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/monitor.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

bool is_compressed(std::string_view name) { return name.ends_with(".dx.gz"); }

MapFormat required_format(std::string_view name) {
  if (const auto format = map_format(name)) return *format;
  throw std::invalid_argument(
      formatted("the map file needs the suffix .dx, .dx.gz or .vti, found {}", name));
}

std::string scientific(Vec3 v) { return formatted("{:.12e} {:.12e} {:.12e}", v.x, v.y, v.z); }

// Returns the title of a map. That of the dielectric has the values inside and outside.
std::string title_of(const MapChoice& map, std::string_view surface) {
  switch (map.quantity) {
    case MapQuantity::inside:
      return formatted("Inside of the {}: 1 inside, 0 outside", surface);
    case MapQuantity::ion_access:
      return "Access of ions: 1 where the centre of an ion may be, 0 elsewhere";
    default:
      return formatted("Dielectric at middles of edges along {}: {:.6g} inside, {:.6g} outside",
                       "xyz"[edge_axis(map.quantity)], map.solute, map.solvent);
  }
}

void require_between(double value, double min, double max, std::string_view what) {
  if (value >= min && value <= max) return;
  throw std::invalid_argument(
      formatted("{} must be between {} and {}, not {}", what, min, max, value));
}

// Header of an OpenDX file as APBS writes it. Some readers depend on its line breaks and words, and
// some accept at most 84 characters a line.
MapLayout dx_layout(const MapChoice& map, std::string_view surface, const Grid& grid,
                    const GridRegion& region) {
  const MapQuantity quantity = map.quantity;
  MapLayout layout;
  layout.value_bytes = is_of_edges(quantity) ? dielectric_text_bytes : 2;
  layout.points = static_cast<std::uint64_t>(region.point_count());
  const std::string counts = formatted("{}", fmt::join(region.size(), " "));
  const double h = grid.spacing;
  Vec3 origin = grid.point(region.begin);
  if (is_of_edges(quantity)) origin[edge_axis(quantity)] += 0.5 * h;
  layout.header = formatted(
      "# {}\n"
      "object 1 class gridpositions counts {}\n"
      "origin {}\ndelta {}\ndelta {}\ndelta {}\n"
      "object 2 class gridconnections counts {}\n"
      "object 3 class array type double rank 0 items {} data follows\n",
      title_of(map, surface), counts, scientific(origin), scientific({h, 0, 0}),
      scientific({0, h, 0}), scientific({0, 0, h}), counts, layout.points);
  layout.footer = formatted(
      "{}attribute \"dep\" string \"positions\"\n"
      "object \"regular positions regular connections\" class field\n"
      "component \"positions\" value 1\n"
      "component \"connections\" value 2\n"
      "component \"data\" value 3\n",
      layout.points % dx_values_per_line != 0 ? "\n" : "");
  return layout;
}

// Points have the indices and the origin of the whole grid.
MapLayout vti_layout(const Grid& grid, const GridRegion& region) {
  MapLayout layout;
  layout.value_bytes = 1;
  layout.points = static_cast<std::uint64_t>(region.point_count());
  const GridIndex &begin = region.begin, &end = region.end;
  const std::string extent = formatted("{} {} {} {} {} {}", begin[0], end[0] - 1, begin[1],
                                       end[1] - 1, begin[2], end[2] - 1);
  layout.header = formatted(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"{0}\" Origin=\"{1}\" Spacing=\"{2} {2} {2}\">\n"
      "    <Piece Extent=\"{0}\">\n"
      "      <PointData Scalars=\"inside\">\n"
      "        <DataArray type=\"UInt8\" Name=\"inside\" format=\"appended\" offset=\"0\"/>\n"
      "      </PointData>\n"
      "      <CellData/>\n"
      "    </Piece>\n"
      "  </ImageData>\n"
      "  <AppendedData encoding=\"raw\">\n_",
      extent, formatted("{} {} {}", grid.origin.x, grid.origin.y, grid.origin.z), grid.spacing);
  for (int byte = 0; byte < 8; ++byte)
    layout.header += static_cast<char>(layout.points >> (8 * byte) & 0xFF);
  layout.footer = "\n  </AppendedData>\n</VTKFile>\n";
  return layout;
}

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

std::optional<MapFormat> map_format(std::string_view name) {
  if (name.ends_with(".dx") || is_compressed(name)) return MapFormat::dx;
  if (name.ends_with(".vti")) return MapFormat::vti;
  return std::nullopt;
}

std::vector<MapChoice> chosen_maps(const Outputs& outputs) {
  std::vector<MapChoice> maps;
  if (!outputs.inside_map.empty())
    maps.push_back({.quantity = MapQuantity::inside,
                    .name = outputs.inside_map,
                    .format = required_format(outputs.inside_map),
                    .gzip = is_compressed(outputs.inside_map)});
  if (outputs.ion_access)
    maps.push_back({.quantity = MapQuantity::ion_access,
                    .name = outputs.ion_access->file,
                    .format = MapFormat::dx,
                    .gzip = is_compressed(outputs.ion_access->file)});
  if (!outputs.dielectric) return maps;
  const auto& [prefix, solute, solvent] = *outputs.dielectric;
  for (const MapQuantity quantity :
       {MapQuantity::dielectric_x, MapQuantity::dielectric_y, MapQuantity::dielectric_z})
    maps.push_back({quantity,
                    formatted("{}{}.dx{}", prefix, "xyz"[edge_axis(quantity)],
                              outputs.gzip ? gzip_suffix : ""),
                    MapFormat::dx, solute, solvent, outputs.gzip});
  return maps;
}

void require_valid_maps(const Outputs& outputs) {
  if (outputs.dielectric) {
    if (outputs.dielectric->prefix.empty())
      throw std::invalid_argument(
          "the prefix of the maps of the dielectric is empty; give the start of their names");
    require_between(outputs.dielectric->solute, min_dielectric, max_dielectric,
                    "the dielectric of the solute");
    require_between(outputs.dielectric->solvent, min_dielectric, max_dielectric,
                    "the dielectric of the solvent");
  }
  if (outputs.ion_access) {
    require_between(outputs.ion_access->ion_radius, 0, max_ion_radius, "the radius of the ions");
    if (map_format(outputs.ion_access->file) != MapFormat::dx)
      throw std::invalid_argument(
          formatted("the map file of ion accessibility needs the suffix .dx or .dx.gz, found {}",
                    outputs.ion_access->file));
  }
  const std::vector<MapChoice> maps = chosen_maps(outputs);
  for (std::size_t i = 0; i < maps.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (maps[i].name == maps[k].name)
        throw std::invalid_argument(formatted("two maps would have the name {}", maps[i].name));
}

double dielectric_of(const MapChoice& map, std::uint32_t fraction) {
  if (fraction == 0) return map.solvent;
  if (fraction == whole_edge) return map.solute;
  const double inside = static_cast<double>(fraction) / whole_edge;
  return 1 / (inside / map.solute + (1 - inside) / map.solvent);
}

MapLayout map_layout(const MapChoice& map, std::string_view surface, const Grid& grid,
                     const GridRegion& region) {
  return map.format == MapFormat::dx ? dx_layout(map, surface, grid, region)
                                     : vti_layout(grid, region);
}

// Consecutive values of a .dx file: those with one x, of some rows along y, and of all planes.
struct GridMap::Slice {
  std::int64_t x = 0, y_begin = 0, y_end = 0;
};

GridMap::GridMap(MapChoice map, std::string_view surface, const Grid& grid,
                 const GridRegion& region)
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
