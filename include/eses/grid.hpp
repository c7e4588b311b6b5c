#pragma once
/// The padded Cartesian grid around a molecule.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "eses/atoms.hpp"

namespace eses {

/// Indices of a grid point, 0-based, along x, y and z.
using GridIndex = std::array<std::int64_t, 3>;

/// The points with begin <= index < end along every axis.
struct GridRegion {
  GridIndex begin{};
  GridIndex end{};

  GridIndex size() const { return {end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]}; }
  std::int64_t point_count() const { return size()[0] * size()[1] * size()[2]; }
  friend bool operator==(const GridRegion&, const GridRegion&) = default;
};

/// Point (i,j,k) stands at `lower + (i,j,k) * spacing`.
struct Grid {
  Vec3 lower;          ///< point (0,0,0), angstrom
  Vec3 upper;          ///< point size - 1, angstrom
  double spacing = 0;  ///< angstrom
  GridIndex size{};    ///< number of points along x, y and z

  double coordinate(std::size_t axis, std::int64_t index) const {
    return lower[axis] + static_cast<double>(index) * spacing;
  }
  Vec3 point(const GridIndex& index) const {
    return {coordinate(0, index[0]), coordinate(1, index[1]), coordinate(2, index[2])};
  }
  std::int64_t point_count() const { return size[0] * size[1] * size[2]; }
  GridRegion whole() const { return {{}, size}; }
};

/// Two opposite corners, angstrom.
struct SphereBounds {
  Vec3 low, high;
};

/// The bounding box of the van der Waals spheres; without atoms, low is +infinity and high
/// -infinity.
SphereBounds sphere_bounds(std::span<const Atom> atoms);

/// The grid of ESES, in the same order of double operations: the van der Waals spheres' bounding
/// box padded by `margin`, the number of points truncated, `n = int((hi - lo) / h) + 1`.
/// Throws Error if there are no atoms, if a parameter is not finite, if spacing <= 0 or margin
/// < 0, or if the number of points exceeds what 64 bits hold.
Grid make_grid(std::span<const Atom> atoms, double spacing, double margin);
Grid make_grid(const SphereBounds& bounds, double spacing, double margin);

/// The points in the closed box between two corners (angstrom). Throws Error if there are none, or
/// if a coordinate of a corner is not finite.
GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high);

/// How far the grid's faces lie inside the bounding box of the van der Waals spheres, the largest
/// of the six, in angstrom: <= 0 where a face only touches, negative where the grid encloses the
/// molecule. The truncation above may take up to one spacing of the margin away.
double cut_depth(const Grid& grid, const SphereBounds& bounds);

}  // namespace eses
