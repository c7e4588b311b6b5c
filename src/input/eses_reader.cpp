#include "input/eses_reader.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include "eses/error.hpp"
#include "geometry/make_grid.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

// Maximum index of an atom. The largest value of AtomIndex is reserved for "no atom".
constexpr std::int64_t max_atom = std::int64_t{std::numeric_limits<AtomIndex>::max()} - 1;

/// Parses the fields of a line, one after the other.
class Fields {
 public:
  Fields(const LineReader& lines, std::string_view line)
      : lines_(lines), line_(line), rest_(line) {}

  bool more() {
    rest_ = without_leading_blanks(rest_);
    return !rest_.empty();
  }

  /// Returns a whole number from 0 to `largest`.
  std::int64_t index(std::string_view name, std::int64_t largest) {
    const std::string_view field = take_first(rest_);
    std::uint64_t value = 0;
    if (!parse_integer(field, value) || value > static_cast<std::uint64_t>(largest))
      refuse(field, name, formatted("a whole number from 0 to {}", largest));
    return static_cast<std::int64_t>(value);
  }

  double number(std::string_view name) {
    const std::string_view field = take_first(rest_);
    double value = 0;
    const std::errc error = parse_number(field, value);
    if (error == std::errc::invalid_argument) refuse(field, name, "a number");
    if (error != std::errc{}) refuse(field, name, "a number that double precision can hold");
    if (!std::isfinite(value)) refuse(field, name, "a finite number");
    return value;
  }

  /// Returns whether a point is inside.
  bool sign(std::string_view name) {
    const std::string_view field = take_first(rest_);
    if (field != "1" && field != "-1") refuse(field, name, "1 (inside) or -1 (outside)");
    return field == "1";
  }

  GridIndex indices(const std::array<std::string_view, 3>& names, std::int64_t largest) {
    return {index(names[0], largest), index(names[1], largest), index(names[2], largest)};
  }

  GridIndex point(const std::array<std::string_view, 3>& names) {
    return indices(names, max_grid_points - 1);
  }

  Vec3 vector(const std::array<std::string_view, 3>& names) {
    return {number(names[0]), number(names[1]), number(names[2])};
  }

  void expect_end() {
    if (more()) refuse(take_first(rest_), "", "the end of the line");
  }

 private:
  // `field` is a view of the line, even if it is empty.
  [[noreturn]] void refuse(std::string_view field, std::string_view name,
                           std::string_view expected) const {
    const auto start = static_cast<std::size_t>(field.data() - line_.data());
    lines_.fail(formatted("field {}{}: expected {}, found {}",
                          count_fields(line_.substr(0, start)) + 1,
                          name.empty() ? "" : formatted(" ({})", name), expected,
                          field.empty() ? "the end of the line" : quoted(field)));
  }

  const LineReader& lines_;
  std::string_view line_, rest_;
};

void check_is_in_grid(const LineReader& lines, const GridIndex& point, const GridIndex& size) {
  if (point[0] < size[0] && point[1] < size[1] && point[2] < size[2]) return;
  lines.fail(formatted("the point {} lies outside the grid of {} points", fmt::join(point, " "),
                       fmt::join(size, " x ")));
}

Vec3 read_corner(LineReader& lines, const std::array<std::string_view, 3>& names) {
  Fields fields(lines, lines.expect(formatted("{}", fmt::join(names, " "))));
  const Vec3 corner = fields.vector(names);
  fields.expect_end();
  return corner;
}

GridIndex read_size(LineReader& lines) {
  Fields fields(lines, lines.expect("nx ny nz"));
  const GridIndex size = fields.indices({"nx", "ny", "nz"}, max_grid_points);
  fields.expect_end();
  double points = 1;
  for (const std::int64_t n : size) points *= static_cast<double>(n);
  if (points < 1 || points > max_point_count)
    lines.fail(formatted("a grid of {} points", fmt::join(size, " x ")));
  return size;
}

void read_row(const LineReader& lines, Fields& fields, const GridIndex& size, GridRow& row) {
  row.point = fields.point({"i", "j", "k"});
  row.inside = fields.sign("s");
  fields.expect_end();
  check_is_in_grid(lines, row.point, size);
}

void read_row(const LineReader& lines, Fields& fields, const GridIndex& size, GridEdge& edge) {
  const GridIndex inside = fields.point({"i", "j", "k"});
  const GridIndex outside = fields.point({"i'", "j'", "k'"});
  check_is_in_grid(lines, inside, size);
  check_is_in_grid(lines, outside, size);
  edge = {};
  std::int64_t steps = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t step = outside[axis] - inside[axis];
    edge.lower[axis] = static_cast<std::int32_t>(std::min(inside[axis], outside[axis]));
    if (step == 0) continue;
    edge.axis = static_cast<std::uint8_t>(axis);
    edge.lower_is_inside = step > 0;
    steps += std::abs(step);
  }
  if (steps != 1)
    lines.fail(formatted("the points {} and {} are not neighbours", fmt::join(inside, " "),
                         fmt::join(outside, " ")));
}

/// Reads the adjacent atoms as a set: in ascending order, without duplicates.
void read_adjacent_atoms(Fields& fields, Crossing& crossing) {
  crossing.atoms = {};
  std::size_t count = 0;
  do {
    crossing.atoms[count++] = static_cast<AtomIndex>(fields.index("atom", max_atom));
  } while (count < crossing.atoms.size() && fields.more());
  fields.expect_end();
  const auto begin = crossing.atoms.begin();
  std::sort(begin, begin + static_cast<std::ptrdiff_t>(count));
  const auto end = std::unique(begin, begin + static_cast<std::ptrdiff_t>(count));
  std::fill(end, crossing.atoms.end(), AtomIndex{0});
  crossing.atom_count = static_cast<std::uint8_t>(end - begin);
}

void read_row(const LineReader& lines, Fields& fields, const GridIndex& size, Crossing& crossing) {
  GridEdge edge;
  read_row(lines, fields, size, edge);
  crossing.lower = {edge.lower[0], edge.lower[1], edge.lower[2]};
  crossing.axis = edge.axis;
  crossing.lower_is_inside = edge.lower_is_inside;
  crossing.position = fields.vector({"px", "py", "pz"});
  crossing.normal = fields.vector({"nx", "ny", "nz"});
  read_adjacent_atoms(fields, crossing);
}

void read_row(const LineReader&, Fields& fields, const GridIndex&, AtomArea& area) {
  area.atom = static_cast<AtomIndex>(fields.index("atom", max_atom));
  area.area = fields.number("area");
  fields.expect_end();
}

}  // namespace

std::optional<std::filesystem::path> find_eses_file(const std::filesystem::path& directory,
                                                    EsesFile file) {
  // Accepts anything of this name, so that opening it gives a specific error.
  const auto is_there = [](const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::symlink_status(path, ignored).type() !=
           std::filesystem::file_type::not_found;
  };
  std::filesystem::path path = directory / name_of(file);
  if (is_there(path)) return path;
  path += gzip_suffix;
  if (is_there(path)) return path;
  return std::nullopt;
}

BoundingBox read_bounding_box(const std::filesystem::path& path) {
  LineReader lines(path);
  BoundingBox box;
  box.lower = read_corner(lines, {"xmin", "ymin", "zmin"});
  box.upper = read_corner(lines, {"xmax", "ymax", "zmax"});
  box.size = read_size(lines);
  std::string_view line;
  if (lines.next(line)) lines.fail("expected the end of the file after three lines");
  return box;
}

template <class Row>
bool RowReader<Row>::next(Row& row) {
  std::string_view line;
  if (!lines_.next(line)) return false;
  Fields fields(lines_, line);
  read_row(lines_, fields, size_, row);
  return true;
}

template class RowReader<GridRow>;
template class RowReader<Crossing>;
template class RowReader<GridEdge>;
template class RowReader<AtomArea>;

}  // namespace eses::detail
