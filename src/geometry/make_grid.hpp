#pragma once
/// Grids and their regions.

#include <array>
#include <span>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "geometry/box.hpp"

namespace eses::detail {

/// Maximum number of points of a grid. It fits into 64 bits.
inline constexpr double max_point_count = 1e17;

/// Returns the bounding box of the van der Waals spheres. Without atoms, `low` is +infinity and
/// `high` is -infinity.
Box sphere_bounds(std::span<const Atom> atoms);

/// Makes the grid of ESES (Liu et al., J. Comput. Chem. 38, 446, 2017, doi:10.1002/jcc.24682), with
/// the same order of floating-point operations. The bounding box of the van der Waals spheres is
/// extended by `margin`, and the number of points along an axis is `int((high - low) / spacing) +
/// 1`. Lengths are in angstrom. Throws std::invalid_argument if there are no atoms, if a parameter
/// is not finite, if spacing <= 0 or margin < 0, or if the grid has more points than require_valid
/// accepts.
Grid make_grid(std::span<const Atom> atoms, double spacing, double margin);
Grid make_grid(const Box& bounds, double spacing, double margin);

/// Throws std::invalid_argument if the bounds of a grid are not finite, if its spacing is not
/// positive, if it has fewer than one point or more than 2e9 points along an axis, or if it has
/// more than `max_point_count` points.
void require_valid(const Grid& grid);

/// Throws std::invalid_argument if a grid that the user has chosen does not pass require_valid, has
/// fewer than two points along an axis, or is so far from the origin of the coordinates that
/// rounding matters.
void require_chosen(const Grid& grid);

/// Returns the points in the closed box between two corners (angstrom). Throws
/// std::invalid_argument if there are none, or if a coordinate of a corner is not finite.
GridRegion points_between(const Grid& grid, Vec3 low, Vec3 high);

/// Throws std::invalid_argument if a region is empty or not within the grid.
void require_within(const GridRegion& region, const Grid& grid);

/// Returns the depth of each face of the grid inside the bounding box of the van der Waals spheres,
/// in angstrom, in the order low x, high x, low y, high y, low z, high z. A face outside the box
/// has a negative depth. A depth within rounding errors is 0: points on such a face may be inside.
/// The grid of ESES can cut the box, as the truncation of the number of points removes up to one
/// spacing of the upper margin.
std::array<double, 6> depths_inside(const Grid& grid, const Box& bounds);

}  // namespace eses::detail
