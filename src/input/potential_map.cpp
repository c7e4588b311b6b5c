#include "input/potential_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "eses/error.hpp"
#include "input/reading_limit.hpp"
#include "input/text_fields.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

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
