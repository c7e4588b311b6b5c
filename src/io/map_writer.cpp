#include "io/map_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "eses/error.hpp"

namespace eses::detail {
namespace {

constexpr std::uint64_t values_per_line = 3;

std::string scientific(Vec3 v) { return fmt::format("{:.12e} {:.12e} {:.12e}", v.x, v.y, v.z); }

// What comes before the values in files of APBS. Readers go by lines and by words of them, some of
// them with 84 characters a line at most.
MapLayout dx_layout(const Grid& grid, const GridRegion& region) {
  MapLayout layout;
  layout.format = MapFormat::dx;
  layout.value_bytes = 2;
  layout.points = static_cast<std::uint64_t>(region.point_count());
  const std::string counts = fmt::format("{}", fmt::join(region.size(), " "));
  const double h = grid.spacing;
  layout.header = fmt::format(
      "# Inside of the solvent excluded surface: 1 inside, 0 outside\n"
      "object 1 class gridpositions counts {}\n"
      "origin {}\ndelta {}\ndelta {}\ndelta {}\n"
      "object 2 class gridconnections counts {}\n"
      "object 3 class array type double rank 0 items {} data follows\n",
      counts, scientific(grid.point(region.begin)), scientific({h, 0, 0}), scientific({0, h, 0}),
      scientific({0, 0, h}), counts, layout.points);
  layout.footer =
      "attribute \"dep\" string \"positions\"\n"
      "object \"regular positions regular connections\" class field\n"
      "component \"positions\" value 1\n"
      "component \"connections\" value 2\n"
      "component \"data\" value 3\n";
  if (layout.points % values_per_line != 0) layout.footer.insert(0, "\n");
  return layout;
}

// Points have the indices and the origin of the whole grid.
MapLayout vti_layout(const Grid& grid, const GridRegion& region) {
  MapLayout layout;
  layout.format = MapFormat::vti;
  layout.value_bytes = 1;
  layout.points = static_cast<std::uint64_t>(region.point_count());
  const GridIndex &begin = region.begin, &end = region.end;
  const std::string extent = fmt::format("{} {} {} {} {} {}", begin[0], end[0] - 1, begin[1],
                                         end[1] - 1, begin[2], end[2] - 1);
  layout.header = fmt::format(
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
      extent, fmt::format("{} {} {}", grid.origin.x, grid.origin.y, grid.origin.z), grid.spacing);
  for (int byte = 0; byte < 8; ++byte)
    layout.header += static_cast<char>(layout.points >> (8 * byte) & 0xFF);
  layout.footer = "\n  </AppendedData>\n</VTKFile>\n";
  return layout;
}

}  // namespace

std::optional<MapFormat> map_format(std::string_view name) {
  if (name.ends_with(".dx")) return MapFormat::dx;
  if (name.ends_with(".vti")) return MapFormat::vti;
  return std::nullopt;
}

MapFormat required_map_format(std::string_view name) {
  if (const auto format = map_format(name)) return *format;
  throw Error(fmt::format("the name of a map must end with .dx or .vti, not {}", name));
}

MapLayout map_layout(MapFormat format, const Grid& grid, const GridRegion& region) {
  return format == MapFormat::dx ? dx_layout(grid, region) : vti_layout(grid, region);
}

void fill_vti_values(std::span<const std::uint64_t> bits, std::span<char> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<char>(bits[i / 64] >> (i % 64) & 1);
}

void fill_dx_zeros(std::uint64_t first_index, std::span<char> text) {
  constexpr std::string_view line = "0 0 0\n";
  static_assert(line.size() == 2 * values_per_line);
  const std::size_t skipped = 2 * static_cast<std::size_t>(first_index % values_per_line);
  const std::size_t start = std::min(text.size(), line.size() - skipped);
  std::memcpy(text.data(), line.data() + skipped, start);
  // Each copy doubles what is there, whole lines of it.
  std::span<char> lines = text.subspan(start);
  std::size_t filled = std::min(lines.size(), line.size());
  std::memcpy(lines.data(), line.data(), filled);
  while (filled < lines.size()) {
    const std::size_t count = std::min(filled, lines.size() - filled);
    std::memcpy(lines.data() + filled, lines.data(), count);
    filled += count;
  }
}

}  // namespace eses::detail
