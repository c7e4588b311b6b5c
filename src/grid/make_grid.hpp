#pragma once
/// Grids around atoms, and their regions.

#include <array>
#include <span>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// The bounding box of the van der Waals spheres; without atoms, low is +infinity and high
/// -infinity.
Box sphere_bounds(std::span<const Atom> atoms);

/// The grid of ESES, in the same order of double operations: the van der Waals spheres' bounding
/// box padded by `margin`, the number of points truncated, `n = int((hi - lo) / h) + 1`.
/// Throws Error if there are no atoms, if a parameter is not finite, if spacing <= 0 or margin
/// < 0, or if the grid has more points than require_valid accepts.
Grid make_grid(std::span<const Atom> atoms, double spacing, double margin);
Grid make_grid(const Box& bounds, double spacing, double margin);

/// Throws Error if a grid, whoever has made it, is not finite, has a spacing that is not positive,
/// fewer than one point or more than 2e9 along an axis, or more than 1e17 points in all.
void require_valid(const Grid& grid);

/// Throws Error if a grid that the user has chosen does not pass require_valid, has fewer than two
/// points along an axis, or is so far from the origin of the coordinates that rounding matters.
void require_chosen(const Grid& grid);

/// The points in the closed box between two corners (angstrom). Throws Error if there are none, or
/// if a coordinate of a corner is not finite.
GridRegion points_between(const Grid& grid, Vec3 low, Vec3 high);

/// Throws Error if a region has no points or goes beyond the grid.
void require_within(const GridRegion& region, const Grid& grid);

/// How far each face of the grid lies inside the bounding box of the van der Waals spheres, in
/// angstrom, in the order low x, high x, low y, high y, low z, high z; negative outside of it.
std::array<double, 6> depths_inside(const Grid& grid, const Box& bounds);

/// How far the grid's faces lie inside the bounding box of the van der Waals spheres, the largest
/// of the six, in angstrom: <= 0 where a face only touches, negative where the grid encloses the
/// molecule. The truncation above may take up to one spacing of the margin away.
double cut_depth(const Grid& grid, const Box& bounds);

}  // namespace eses::detail
