#include "output/map_writer.hpp"

#include <fmt/ranges.h>

#include <stdexcept>

#include "system/formatted.hpp"
#include "system/gzip.hpp"

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
std::string title_of(const MapChoice& map, SurfaceKind surface) {
  switch (map.quantity) {
    case MapQuantity::inside:
      return formatted("Inside of the {}: 1 inside, 0 outside", names_of(surface).name);
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
MapLayout dx_layout(const MapChoice& map, SurfaceKind surface, const Grid& grid,
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

MapLayout map_layout(const MapChoice& map, SurfaceKind surface, const Grid& grid,
                     const GridRegion& region) {
  return map.format == MapFormat::dx ? dx_layout(map, surface, grid, region)
                                     : vti_layout(grid, region);
}

}  // namespace eses::detail
