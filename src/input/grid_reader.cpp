#include "input/grid_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "eses/error.hpp"
#include "geometry/make_grid.hpp"
#include "input/eses_reader.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Spacings that differ by a smaller relative amount are treated as equal. APBS prints seven digits.
constexpr double spacing_precision = 2e-6;
// Maximum number of lines before the data. Valid files have a few lines; the limit stops the search
// in files of other formats.
constexpr int max_header_lines = 1000;

Vec3 vector_in(const LineReader& lines, std::string_view& fields, std::string_view what) {
  Vec3 vector;
  for (std::size_t axis = 0; axis < 3; ++axis) vector[axis] = number_in(lines, fields, what);
  return vector;
}

// Parses a whole number of at least `min`.
std::int64_t index_in(const LineReader& lines, std::string_view& fields, std::string_view what,
                      std::int64_t min) {
  const double value = number_in(lines, fields, what);
  if (value != std::floor(value) || value < static_cast<double>(min) ||
      value > static_cast<double>(max_grid_points))
    lines.fail(formatted("{}: expected a whole number from {} to {}, found {}", what, min,
                         max_grid_points, value));
  return static_cast<std::int64_t>(value);
}

void require_positive(const LineReader& lines, const Vec3& spacing) {
  for (const double value : {spacing.x, spacing.y, spacing.z})
    if (!(value > 0))
      lines.fail(formatted("expected a positive spacing along x, y and z, found {}, {} and {}",
                           spacing.x, spacing.y, spacing.z));
}

// Returns the spacing, which must be the same along all axes.
double common_spacing(const LineReader& lines, const Vec3& spacing) {
  for (const double value : {spacing.y, spacing.z})
    if (!is_same_spacing(value, spacing.x))
      lines.fail(formatted(
          "the spacing is {} along x, {} along y and {} along z; it must be the same along all "
          "axes, such as by an equal ratio of length and cells",
          spacing.x, spacing.y, spacing.z));
  return spacing.x;
}

// Returns the axis along which the points of a map lie half a spacing behind the points of the
// grid, as a comment of eses-blocks or APBS says for maps of the dielectric.
std::optional<std::size_t> shifted_axis(std::string_view comment) {
  constexpr std::string_view own = "Dielectric at middles of edges along ";
  constexpr std::string_view apbs = "-SHIFTED DIELECTRIC MAP";
  char axis = 0;
  if (comment.starts_with(own) && comment.size() > own.size()) axis = comment[own.size()];
  const std::size_t end = comment.find(apbs);
  if (end != std::string_view::npos && end > 0)
    axis = static_cast<char>(std::tolower(static_cast<unsigned char>(comment[end - 1])));
  if (axis < 'x' || axis > 'z') return std::nullopt;
  return static_cast<std::size_t>(axis - 'x');
}

Grid read_dx(const std::filesystem::path& path) {
  LineReader lines(path);
  const DxPositions positions = read_dx_positions(lines);
  Grid grid{positions.origin, common_spacing(lines, positions.spacing), positions.size};
  if (positions.shifted_axis) grid.origin[*positions.shifted_axis] -= 0.5 * grid.spacing;
  return grid;
}

// Returns the value of an attribute of an XML tag.
std::string_view attribute_in(const LineReader& lines, std::string_view tag,
                              std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    std::string_view rest = tag.substr(at + name.size());
    const bool is_whole_name = at > 0 && tag[at - 1] == ' ';
    if (!is_whole_name || rest.size() < 2 || rest[0] != '=') continue;
    const char quote = rest[1];
    rest.remove_prefix(2);
    const std::size_t end = rest.find(quote);
    if ((quote == '"' || quote == '\'') && end != std::string_view::npos)
      return rest.substr(0, end);
  }
  lines.fail(formatted("the tag ImageData has no attribute {}", name));
}

// Returns the tag <ImageData ...>, with line ends replaced by blanks.
std::string image_tag(LineReader& lines) {
  constexpr std::string_view begin = "<ImageData";
  std::string tag;
  for (int i = 0; i < max_header_lines; ++i) {
    std::string_view line = lines.expect("the tag ImageData of VTK image data");
    if (tag.empty()) {
      const std::size_t at = line.find(begin);
      if (at == std::string_view::npos) continue;
      line.remove_prefix(at);
    }
    const std::size_t end = line.find('>');
    tag += formatted("{} ", line.substr(0, end));
    if (end != std::string_view::npos) return tag;
  }
  lines.fail("expected the tag ImageData of VTK image data");
}

// Reads the grid of VTK image data. Its indices need not start at 0.
Grid read_vti(const std::filesystem::path& path) {
  LineReader lines(path);
  const std::string tag = image_tag(lines);
  std::string_view extent = attribute_in(lines, tag, "WholeExtent");
  std::string_view origin = attribute_in(lines, tag, "Origin");
  std::string_view spacing = attribute_in(lines, tag, "Spacing");
  Grid grid;
  grid.origin = vector_in(lines, origin, "Origin");
  const Vec3 spacings = vector_in(lines, spacing, "Spacing");
  require_positive(lines, spacings);
  grid.spacing = common_spacing(lines, spacings);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = index_in(lines, extent, "WholeExtent", -max_grid_points);
    const std::int64_t last = index_in(lines, extent, "WholeExtent", first);
    grid.origin[axis] = grid.coordinate(axis, first);
    grid.size[axis] = last - first + 1;
  }
  return grid;
}

// Returns the tolerance of the last corner: corners are written with 13 digits.
double corner_precision(const BoundingBox& box, std::size_t axis) {
  constexpr double printed = 1e-12;
  return printed * std::max(std::fabs(box.lower[axis]), std::fabs(box.upper[axis]));
}

bool fits(const BoundingBox& box, double spacing) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = static_cast<double>(box.size[axis] - 1) * spacing;
    if (!(std::fabs(box.lower[axis] + length - box.upper[axis]) <= corner_precision(box, axis)))
      return false;
  }
  return true;
}

// The corners are rounded, so a range of spacings is consistent with them. The spacing with the
// shortest decimal text is most likely the original one.
double shortest_spacing(const BoundingBox& box, double estimate) {
  for (int digits = 1; digits < 17; ++digits) {
    double spacing = 0;
    if (parse_number(formatted("{:.{}e}", estimate, digits - 1), spacing) == std::errc() &&
        fits(box, spacing))
      return spacing;
  }
  return estimate;
}

Grid read_box(const std::filesystem::path& path) {
  const BoundingBox box = read_bounding_box(path);
  const auto longest = static_cast<std::size_t>(std::max_element(box.size.begin(), box.size.end()) -
                                                box.size.begin());
  const auto cells = static_cast<double>(box.size[longest] - 1);
  const double spacing = (box.upper[longest] - box.lower[longest]) / cells;
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw Error(formatted("{}: the corners and counts give no valid spacing", path.string()));
  Grid grid{box.lower, shortest_spacing(box, spacing), box.size};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::fabs(grid.upper()[axis] - box.upper[axis]) >
        spacing_precision * grid.spacing * static_cast<double>(box.size[axis]))
      throw Error(
          formatted("{}: the corners give different spacings along the axes; they must be equal",
                    path.string()));
  return grid;
}

// Maximum number of lines between the positions and the values.
constexpr int max_lines_between = 1000;
constexpr double max_values = 1e15;  // far more than memory has room for

std::uint64_t count_values(const LineReader& lines, const GridIndex& size) {
  double count = 1;
  for (const std::int64_t points : size) {
    if (points < 2) lines.fail("expected at least two points along x, y and z");
    count *= static_cast<double>(points);
  }
  if (count > max_values) lines.fail(formatted("the map has more than {:g} points", max_values));
  return static_cast<std::uint64_t>(count);
}

void require_memory(const std::string& name, std::uint64_t bytes, std::uint64_t max_memory) {
  ReadingLimit(max_memory).require(bytes, formatted("{}: the map of the potential", name));
  if (const std::uint64_t available = available_memory(); bytes > available)
    throw MemoryLimitError(
        formatted("{}: the map of the potential needs {} of memory, but {} are available", name,
                  bytes_text(bytes), bytes_text(available)));
}

// Finds the line before the values, which ends with the words `data follows`.
void skip_to_values(LineReader& lines, std::uint64_t count) {
  for (int i = 0; i < max_lines_between; ++i) {
    std::string_view fields = lines.expect("the values of an OpenDX map");
    std::string_view before = fields;
    if (take_last(before) != "follows" || take_last(before) != "data") continue;
    for (std::string_view word = take_first(fields); !word.empty() && word != "items";
         word = take_first(fields))
      if (word == "rank" && number_in(lines, fields, "rank") != 0)
        lines.fail("the map has vectors; expected a map of a potential, with rank 0");
    if (number_in(lines, fields, "items") != static_cast<double>(count))
      lines.fail(formatted("expected {} items, a value for each point", count));
    return;
  }
  lines.fail("expected a line that ends with 'data follows', before the values of an OpenDX map");
}

}  // namespace

bool is_same_spacing(double a, double b) {
  return std::fabs(a - b) <= spacing_precision * std::max(a, b);
}

std::optional<GridFileFormat> grid_file_format(std::string_view name) {
  if (name.ends_with(gzip_suffix)) name.remove_suffix(gzip_suffix.size());
  if (name.ends_with(".dx")) return GridFileFormat::dx;
  if (name.ends_with(".vti")) return GridFileFormat::vti;
  if (name.ends_with(".txt")) return GridFileFormat::box;
  return std::nullopt;
}

double number_in(const LineReader& lines, std::string_view& fields, std::string_view what) {
  const std::string_view field = take_first(fields);
  double value = 0;
  if (parse_number(field, value) != std::errc() || !std::isfinite(value))
    lines.fail(formatted("{}: expected a finite number, found {}", what,
                         field.empty() ? "the end of the line" : quoted(field)));
  return value;
}

DxPositions read_dx_positions(LineReader& lines) {
  DxPositions positions;
  std::size_t deltas = 0;
  bool has_counts = false, has_origin = false;
  for (int i = 0; i < max_header_lines && deltas < 3; ++i) {
    std::string_view fields = lines.expect("the positions of an OpenDX grid");
    const std::string_view keyword = take_first(fields);
    if (keyword == "#" && !positions.shifted_axis) {
      positions.shifted_axis = shifted_axis(without_leading_blanks(fields));
    } else if (keyword == "object" && fields.find("gridpositions") != std::string_view::npos) {
      while (!fields.empty() && take_first(fields) != "counts") continue;
      for (std::int64_t& count : positions.size) count = index_in(lines, fields, "counts", 1);
      has_counts = true;
    } else if (keyword == "origin" && has_counts) {
      positions.origin = vector_in(lines, fields, "origin");
      has_origin = true;
    } else if (keyword == "delta" && has_origin) {
      Vec3 delta = vector_in(lines, fields, "delta");
      positions.spacing[deltas] = delta[deltas];
      delta[deltas] = 0;
      if (delta != Vec3{})
        lines.fail("the axes of the grid must be those of the coordinates, in the order x, y, z");
      ++deltas;
    }
  }
  if (deltas < 3) lines.fail("expected the positions of an OpenDX grid: counts, origin and delta");
  require_positive(lines, positions.spacing);
  return positions;
}

// ------------------------------------------------------------------------------ maps of potentials

PotentialMap::PotentialMap(const std::filesystem::path& path, std::uint64_t max_memory)
    : name_(path.string()) {
  LineReader lines(path);
  positions_ = read_dx_positions(lines);
  const std::uint64_t count = count_values(lines, positions_.size);
  skip_to_values(lines, count);
  require_memory(name_, count * sizeof(float), max_memory);
  values_.resize(count);
  read_values(lines);
}

void PotentialMap::read_values(LineReader& lines) {
  std::string_view fields;
  for (float& value : values_) {
    while (fields = without_leading_blanks(fields), fields.empty())
      if (!lines.next_part(fields)) lines.expect("a value for each point");
    value = static_cast<float>(number_in(lines, fields, "potential"));
    if (!std::isfinite(value)) lines.fail("potential: the number is too large");
  }
  double surplus = 0;
  while (trimmed(fields).empty() && lines.next_part(fields)) continue;
  if (parse_number(take_first(fields), surplus) == std::errc())
    lines.fail(formatted("more than {} values, one for each point", values_.size()));
}

double PotentialMap::at(const Vec3& position) const {
  const auto& [origin, spacing, size, shifted] = positions_;
  std::array<std::size_t, 3> cell{};
  std::array<double, 3> fraction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = (position[axis] - origin[axis]) / spacing[axis];
    const auto last = static_cast<double>(size[axis] - 1);
    if (!(step >= 0 && step <= last)) {
      Vec3 end = origin;
      for (std::size_t i = 0; i < 3; ++i) end[i] += static_cast<double>(size[i] - 1) * spacing[i];
      throw Error(formatted(
          "{}: the mesh has points outside of the map, which is from {:.6g} {:.6g} {:.6g} to "
          "{:.6g} {:.6g} {:.6g} (angstrom); use a larger map",
          name_, origin.x, origin.y, origin.z, end.x, end.y, end.z));
    }
    const double low = std::min(std::floor(step), last - 1);
    cell[axis] = static_cast<std::size_t>(low);
    fraction[axis] = step - low;
  }
  const auto ny = static_cast<std::size_t>(size[1]), nz = static_cast<std::size_t>(size[2]);
  const auto along_z = [&](std::size_t x, std::size_t y) {
    const float* const values = &values_[(x * ny + y) * nz + cell[2]];
    return std::lerp(double{values[0]}, double{values[1]}, fraction[2]);
  };
  const auto along_y = [&](std::size_t x) {
    return std::lerp(along_z(x, cell[1]), along_z(x, cell[1] + 1), fraction[1]);
  };
  return std::lerp(along_y(cell[0]), along_y(cell[0] + 1), fraction[0]);
}

std::string PotentialMap::identity() const {
  const auto& [origin, spacing, size, shifted] = positions_;
  const std::uint32_t hash = checksum({reinterpret_cast<const char*>(values_.data()), bytes()});
  return formatted("{:a} {:a} {:a} {:a} {:a} {:a} {} {} {} {:08x}", origin.x, origin.y, origin.z,
                   spacing.x, spacing.y, spacing.z, size[0], size[1], size[2], hash);
}

}  // namespace eses::detail

namespace eses {

Grid read_grid(const std::filesystem::path& path) {
  using detail::GridFileFormat;
  const auto format = detail::grid_file_format(path.filename().string());
  if (!format)
    throw Error(detail::formatted(
        "{}: a grid file needs the suffix .dx, .vti or .txt, or one of these and .gz",
        path.string()));
  const Grid grid = *format == GridFileFormat::dx    ? detail::read_dx(path)
                    : *format == GridFileFormat::vti ? detail::read_vti(path)
                                                     : detail::read_box(path);
  try {
    detail::require_chosen(grid);
  } catch (const std::invalid_argument& error) {
    throw Error(detail::formatted("{}: {}", path.string(), error.what()));
  }
  return grid;
}

}  // namespace eses
