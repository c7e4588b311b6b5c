#pragma once
/// Readers for the files that ESES and this program write. The files may be plain or gzipped, with
/// lines in any order and numbers in any format of C or Fortran. They are read line by line. All
/// readers throw Error with the file, line and field of the first error.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>

#include "eses/atoms.hpp"
#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "eses/vec3.hpp"
#include "input/text_source.hpp"

namespace eses::detail {

enum class EsesFile { box, grid, edges, areas };

inline constexpr std::array<std::string_view, 4> eses_file_names{
    "bounding_box.txt", "grid_info.txt", "intersection_info.txt", "partition_area.txt"};

constexpr std::string_view name_of(EsesFile file) {
  return eses_file_names[static_cast<std::size_t>(file)];
}

/// Returns the path of NAME in `directory` or, if it does not exist, of NAME.gz.
std::optional<std::filesystem::path> find_eses_file(const std::filesystem::path& directory,
                                                    EsesFile file);

/// The contents of bounding_box.txt.
struct BoundingBox {
  Vec3 lower, upper;  ///< first and last grid point, angstrom
  GridIndex size{};   ///< points along x, y and z, > 0
};

BoundingBox read_bounding_box(const std::filesystem::path& path);

/// Maximum number of points along an axis that the readers accept. It also serves as the size of a
/// grid of unknown size.
inline constexpr std::int64_t max_grid_points = std::numeric_limits<std::int32_t>::max();
inline constexpr GridIndex unknown_size{max_grid_points, max_grid_points, max_grid_points};

/// A line of grid_info.txt.
struct GridRow {
  GridIndex point{};
  bool inside = false;
};

/// A grid edge with one end inside and one outside. Edges are ordered by their lower grid point (z,
/// then y, then x), then by axis.
struct GridEdge {
  std::array<std::int32_t, 3> lower{};  ///< grid index of its lower end
  std::uint8_t axis = 0;                ///< 0, 1, 2: it runs along x, y, z
  bool lower_is_inside = false;

  GridIndex inside() const { return end(lower_is_inside ? 0 : 1); }
  GridIndex outside() const { return end(lower_is_inside ? 1 : 0); }

  friend bool operator==(const GridEdge&, const GridEdge&) = default;
  friend std::strong_ordering operator<=>(const GridEdge& a, const GridEdge& b) {
    if (const auto order = a.high_key() <=> b.high_key(); order != 0) return order;
    return a.low_key() <=> b.low_key();
  }

 private:
  GridIndex end(std::int64_t step) const {
    GridIndex index{lower[0], lower[1], lower[2]};
    index[axis] += step;
    return index;
  }
  std::int64_t high_key() const { return std::int64_t{lower[2]} << 32 | lower[1]; }
  std::int64_t low_key() const {
    return std::int64_t{lower[0]} << 3 | axis << 1 | static_cast<int>(lower_is_inside);
  }
};

/// Returns the edge of a crossing.
inline GridEdge edge_of(const Crossing& crossing) {
  const auto lower = [&](std::size_t axis) {
    return static_cast<std::int32_t>(crossing.lower[axis]);
  };
  return {{lower(0), lower(1), lower(2)}, crossing.axis, crossing.lower_is_inside};
}

/// A line of partition_area.txt.
struct AtomArea {
  AtomIndex atom = 0;
  double area = 0;  ///< square angstrom
};

/// Reads a file line by line. A Row is a GridRow, a Crossing, a GridEdge or an AtomArea. For a
/// GridEdge, only the edge of a crossing is parsed. Points are checked against the size of the
/// grid.
template <class Row>
class RowReader {
 public:
  explicit RowReader(const std::filesystem::path& path, const GridIndex& size = unknown_size)
      : lines_(path), size_(size) {}

  /// Reads the next line. Returns false at the end of the file.
  bool next(Row& row);

 private:
  LineReader lines_;
  GridIndex size_;
};

}  // namespace eses::detail
