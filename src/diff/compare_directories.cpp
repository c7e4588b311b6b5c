#include "diff/compare_directories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <system_error>

#include "diff/compare_areas.hpp"
#include "diff/compare_edges.hpp"
#include "diff/compare_points.hpp"
#include "eses/error.hpp"
#include "input/eses_reader.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr std::array every_file{EsesFile::box, EsesFile::grid, EsesFile::edges, EsesFile::areas};

/// One file of either directory.
using Paths = Sides<std::optional<std::filesystem::path>>;
using AllPaths = std::array<Paths, every_file.size()>;

const Paths& paths_of(const AllPaths& paths, EsesFile file) {
  return paths[static_cast<std::size_t>(file)];
}

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

/// Throws Error if a directory has no file to compare.
void expect_files(const AllPaths& paths, const Sides<std::filesystem::path>& directories) {
  for (const std::size_t side : both_sides) {
    const bool has_one = std::any_of(paths.begin(), paths.end(),
                                     [side](const Paths& file) { return file[side].has_value(); });
    if (has_one) continue;
    throw Error(formatted("{}: holds none of {}, plain or gzipped", directories[side].string(),
                          fmt::join(eses_file_names, ", ")));
  }
}

AllPaths find_files(const Sides<std::filesystem::path>& directories) {
  for (const std::filesystem::path& directory : directories) expect_directory(directory);
  AllPaths paths;
  for (const EsesFile file : every_file) {
    for (const std::size_t side : both_sides) {
      auto& path = paths[static_cast<std::size_t>(file)][side];
      path = find_eses_file(directories[side], file);
      if (path) expect_regular_file(*path);
    }
  }
  expect_files(paths, directories);
  return paths;
}

/// The grids, as far as they are known from the bounding boxes or else from the points.
struct Grids {
  Sides<std::optional<BoundingBox>> boxes;
  Sides<std::optional<GridIndex>> sizes;
  ComparedGrids of_boxes;

  bool same_size() const { return !sizes[0] || !sizes[1] || *sizes[0] == *sizes[1]; }
};

/// Returns the spacing (angstrom), or nothing for a grid of one point.
std::optional<double> spacing_of(const BoundingBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.size[axis] < 2) continue;
    return (box.upper[axis] - box.lower[axis]) / static_cast<double>(box.size[axis] - 1);
  }
  return std::nullopt;
}

Grids read_grids(const AllPaths& paths) {
  Grids grids;
  for (const std::size_t side : both_sides) {
    if (const auto& box = paths_of(paths, EsesFile::box)[side]) {
      grids.boxes[side] = read_bounding_box(*box);
      grids.sizes[side] = grids.of_boxes.sizes[side] = grids.boxes[side]->size;
      if (!grids.of_boxes.spacing) grids.of_boxes.spacing = spacing_of(*grids.boxes[side]);
    } else if (const auto& points = paths_of(paths, EsesFile::grid)[side]) {
      grids.sizes[side] = extent_of_points(*points);
    }
  }
  return grids;
}

FileStatus status_of(EsesFile file, const Paths& paths, const Grids& grids) {
  if (!paths[0]) return paths[1] ? FileStatus::only_in_b : FileStatus::in_neither;
  if (!paths[1]) return FileStatus::only_in_a;
  const bool needs_same_grid = file == EsesFile::grid || file == EsesFile::edges;
  return needs_same_grid && !grids.same_size() ? FileStatus::other_grid : FileStatus::compared;
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

}  // namespace

Differences compare_directories(const Sides<std::filesystem::path>& directories, double tolerance) {
  const AllPaths paths = find_files(directories);
  const Grids grids = read_grids(paths);
  Differences result;
  for (const EsesFile file : every_file) {
    result.status[static_cast<std::size_t>(file)] = status_of(file, paths_of(paths, file), grids);
  }
  const auto is_compared = [&result](EsesFile file) {
    return result.status_of(file) == FileStatus::compared;
  };
  const auto both = [&paths](EsesFile file) {
    const Paths& pair = paths_of(paths, file);
    return Sides<std::filesystem::path>{*pair[0], *pair[1]};
  };

  if (is_compared(EsesFile::box)) {
    result.box = compare_boxes({*grids.boxes[0], *grids.boxes[1]}, tolerance);
  }
  if (is_compared(EsesFile::grid)) {
    result.points = compare_points(both(EsesFile::grid), *grids.sizes[0]);
  }
  AreaShifts shifts;
  if (is_compared(EsesFile::edges)) {
    result.edges = compare_edges(both(EsesFile::edges), grids.of_boxes, tolerance, shifts);
  }
  if (is_compared(EsesFile::areas)) {
    result.areas = compare_areas(both(EsesFile::areas), shifts, tolerance);
  }
  return result;
}

}  // namespace eses::detail
