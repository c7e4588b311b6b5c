#include "diff/compare_directories.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <system_error>
#include <unordered_map>
#include <vector>

#include "diff/match_in_order.hpp"
#include "eses/error.hpp"
#include "input/eses_reader.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// The paths of a file in both directories; empty where it is missing.
using FoundFiles = Sides<std::optional<std::filesystem::path>>;

void expect_directory(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return;
  throw Error(formatted("{}: {}", path.string(), error ? error.message() : "not a directory"));
}

/// Throws Error for pipes and devices: opening a pipe would wait for a writer. Other files
/// that cannot be read, such as directories, cause an error when they are opened.
void expect_regular_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_other(std::filesystem::status(path, ignored)))
    throw Error(formatted("{}: not a regular file", path.string()));
}

FoundFiles find_files(const Sides<std::filesystem::path>& directories, EsesFile file) {
  FoundFiles paths;
  for (const std::size_t side : both_sides) {
    paths[side] = find_eses_file(directories[side], file);
    if (paths[side]) expect_regular_file(*paths[side]);
  }
  return paths;
}

BoxDifference compare_boxes(const Sides<BoundingBox>& boxes, double tolerance) {
  BoxDifference result;
  result.boxes = boxes;
  const auto& [a, b] = boxes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.corners = std::max({result.corners, std::fabs(a.lower[axis] - b.lower[axis]),
                               std::fabs(a.upper[axis] - b.upper[axis])});
  }
  result.same_corners = result.corners <= tolerance;
  result.same_size = a.size == b.size;
  return result;
}

std::vector<AtomArea> read_areas(const std::filesystem::path& path) {
  std::vector<AtomArea> areas;
  AtomArea area;
  for (RowReader<AtomArea> reader(path); reader.next(area);) areas.push_back(area);
  std::stable_sort(areas.begin(), areas.end(),
                   [](const AtomArea& a, const AtomArea& b) { return a.atom < b.atom; });
  return areas;
}

double total_of(const std::vector<AtomArea>& areas) {
  double total = 0;
  for (const AtomArea& area : areas) total += area.area;
  return total;
}

/// Compares the areas of atoms. `shifts` are those of the compared edges.
AreaDifference compare_areas(const Sides<std::filesystem::path>& paths,
                             const std::unordered_map<AtomIndex, double>& shifts,
                             double tolerance) {
  const std::vector<AtomArea> a = read_areas(paths[0]), b = read_areas(paths[1]);
  AreaDifference result;
  result.total = {total_of(a), total_of(b)};
  const auto compare = [&](const AtomArea& in_a, const AtomArea& in_b) {
    const double difference = in_a.area - in_b.area;
    const auto shift = shifts.find(in_a.atom);
    const double explained = shift == shifts.end() ? 0 : shift->second;
    result.area.add(in_a.atom, std::fabs(difference), tolerance);
    result.unexplained.add(in_a.atom, std::fabs(difference - explained), tolerance);
  };
  result.matching = match_in_order<AtomArea>(
      {stream_of(a), stream_of(b)}, [](const AtomArea& area) { return area.atom; }, compare);
  return result;
}

/// Returns the result of `compare`, which is called if both directories have the file and their
/// grids are comparable.
template <class Compare>
auto compare_found(const FoundFiles& files, bool are_comparable, const Compare& compare) {
  using Paths = Sides<std::filesystem::path>;
  FileComparison<decltype(compare(Paths()))> comparison;
  const auto& [a, b] = files;
  if (a && b && are_comparable) {
    comparison = {FileStatus::compared, compare(Paths{*a, *b})};
  } else if (a && b) {
    comparison.status = FileStatus::other_grid;
  } else if (a || b) {
    comparison.status = a ? FileStatus::only_in_a : FileStatus::only_in_b;
  }
  return comparison;
}

}  // namespace

Differences compare_directories(const Sides<std::filesystem::path>& directories, double tolerance) {
  for (const std::filesystem::path& directory : directories) expect_directory(directory);
  std::array<FoundFiles, eses_file_names.size()> found;
  for (std::size_t file = 0; file < found.size(); ++file)
    found[file] = find_files(directories, static_cast<EsesFile>(file));
  const auto& [box_files, point_files, edge_files, area_files] = found;
  for (const std::size_t side : both_sides)
    if (std::ranges::none_of(found,
                             [&](const FoundFiles& files) { return files[side].has_value(); }))
      throw Error(formatted("{}: holds none of {}, plain or gzipped", directories[side].string(),
                            fmt::join(eses_file_names, ", ")));
  Sides<std::optional<BoundingBox>> boxes;
  Sides<std::optional<GridIndex>> sizes;
  for (const std::size_t side : both_sides) {
    if (box_files[side]) {
      boxes[side] = read_bounding_box(*box_files[side]);
      sizes[side] = boxes[side]->size;
    } else if (point_files[side]) {
      sizes[side] = extent_of_points(*point_files[side]);
    }
  }
  const bool is_same_size = !sizes[0] || !sizes[1] || *sizes[0] == *sizes[1];
  Differences result;
  result.box = compare_found(box_files, true, [&](const auto& /*paths*/) {
    return compare_boxes({*boxes[0], *boxes[1]}, tolerance);
  });
  result.points = compare_found(point_files, is_same_size, [&](const auto& paths) {
    return compare_points(paths, *sizes[0]);
  });
  result.edges = compare_found(edge_files, is_same_size, [&](const auto& paths) {
    return compare_edges(paths, boxes, tolerance);
  });
  result.areas = compare_found(area_files, true, [&](const auto& paths) {
    return compare_areas(paths, result.edges.found.area_shifts, tolerance);
  });
  return result;
}

}  // namespace eses::detail
