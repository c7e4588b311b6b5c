#pragma once
/// @file
/// Cartesian grids.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "eses/vec3.hpp"

#pragma GCC visibility push(default)
namespace eses {

class Surface;

/// Indices of a grid point along x, y and z, from 0.
using GridIndex = std::array<std::int64_t, 3>;

/// The points with begin <= index < end along every axis.
struct GridRegion {
  GridIndex begin{};  ///< Lowest point.
  GridIndex end{};    ///< Index of the highest point plus one, along each axis.

  /// Number of points along each axis.
  GridIndex size() const { return {end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]}; }
  /// Number of points.
  std::int64_t point_count() const { return size()[0] * size()[1] * size()[2]; }
  /// Returns whether a point is in the region.
  bool contains(const GridIndex& point) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (point[axis] < begin[axis] || point[axis] >= end[axis]) return false;
    return true;
  }
  /// Compares both corners.
  friend bool operator==(const GridRegion&, const GridRegion&) = default;
};

/// A grid with the same spacing along all axes: point (i, j, k) is at
/// `origin + (i, j, k) * spacing`. An edge joins two points whose indices differ by one along one
/// axis.
struct Grid {
  Vec3 origin;         ///< Point (0, 0, 0), in angstrom.
  double spacing = 0;  ///< Distance of neighbouring points, in angstrom.
  GridIndex size{};    ///< Number of points along x, y and z.

  /// A coordinate of the points with this index along an axis, in angstrom.
  double coordinate(std::size_t axis, std::int64_t index) const {
    return origin[axis] + static_cast<double>(index) * spacing;
  }
  /// The position of a point, in angstrom.
  Vec3 point(const GridIndex& index) const {
    return {coordinate(0, index[0]), coordinate(1, index[1]), coordinate(2, index[2])};
  }
  /// The highest point, in angstrom.
  Vec3 upper() const { return point({size[0] - 1, size[1] - 1, size[2] - 1}); }
  /// Number of points.
  std::int64_t point_count() const { return size[0] * size[1] * size[2]; }
  /// The region of all points.
  GridRegion whole() const { return {{}, size}; }
};

/// Choices of make_grid.
struct GridOptions {
  double spacing = 0.4;  ///< Distance of neighbouring points, in angstrom; positive.
  /// Distance of the grid's faces from the van der Waals spheres, in angstrom, before the number of
  /// points is truncated; not negative, and at least half the spacing unless the truncated grid
  /// still encloses all spheres.
  double margin = 0.8;
};

/// Makes the grid of ESES (Liu et al., J. Comput. Chem. 38, 446, 2017, doi:10.1002/jcc.24682). It
/// is the bounding box of the van der Waals spheres, extended by the margin on all sides. Along
/// each axis it has `int((high - low) / spacing) + 1` points, so that up to one spacing of the
/// upper margin may be missing.
///
/// Throws std::invalid_argument if an option is out of its range or not finite, or if there would
/// be more than 2e9 points along an axis or 1e17 in all.
Grid make_grid(const Surface& surface, const GridOptions& options = {});

/// Throws std::invalid_argument if a grid is not valid: if it has fewer than one or more than 2e9
/// points along an axis, more than 1e17 points, a spacing that is not positive, or bounds that are
/// not finite.
void validate(const Grid& grid);

/// Returns a grid with its centre at a given point. `center` and `spacing` are in angstrom. The
/// arguments are not checked; see validate.
Grid centered_grid(Vec3 center, double spacing, const GridIndex& size);

/// Reads the grid of a file: an OpenDX map (`.dx`, as APBS writes it), VTK image data (`.vti`) or
/// bounding_box.txt (`.txt`), plain or gzipped (with the additional suffix `.gz`). Only the header
/// of a map is read. A map of the dielectric, as its first lines name it, gives the grid whose
/// edges have the values. The corners in bounding_box.txt are rounded, so several spacings are
/// consistent with them; the grid has the one with the fewest decimal digits.
///
/// Throws Error, with the file and line, if the file cannot be read or has another format, if the
/// axes of the grid are not along x, y and z, if the spacings of the axes differ in the first six
/// digits, or if the grid has less than two points along an axis.
Grid read_grid(const std::filesystem::path& path);

/// Returns the points in the closed box between two corners, in angstrom. Throws
/// std::invalid_argument if the box contains no point, or if a coordinate is not finite.
GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high);

/// Blocks of a grid with indices in [begin, end) along every axis.
struct BlockRange {
  GridIndex begin{};  ///< Indices of the first block.
  GridIndex end{};    ///< Indices of the last block plus 1.
};

/// Returns the points that a range of blocks owns. The whole grid is divided into blocks with
/// `block_size` points on a side; neighbouring blocks share their faces. Throws
/// std::invalid_argument if the block size is not 2 to 4096, or if the range is empty or not within
/// the grid.
GridRegion points_of_blocks(const Grid& grid, std::int64_t block_size, const BlockRange& blocks);

}  // namespace eses
#pragma GCC visibility pop
