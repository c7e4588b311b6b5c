#pragma once
/// Tests of the points and crossings of a result against the definition of the surface.

#include <string>

#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "verify/definition.hpp"

namespace eses::detail::verify {

/// Tests a point. Returns an empty text, or a line that names the point and its fault. A point is
/// wrong if it is more than 1e-6 angstrom on the other side of the surface, whether or not
/// uncertain centres count as accessible: see `Access`.
std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside);

/// Tests a crossing. Returns an empty text, or a line that names its edge and the fault. The ends
/// of the edge must be on their sides of the surface. The crossing must lie on the edge, on the
/// surface, and on the patch of its atoms. The normal must lead to an accessible centre at which
/// the probe touches these atoms. All points between the crossing and the outside end must be
/// outside.
std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Crossing& crossing);

/// Returns the distance of a crossing from the seam with another patch, at most 0.02 probe radii or
/// 0.028 angstrom. The normal is assumed to be correct.
double distance_to_seam(CentreSearch& search, const Crossing& crossing);

}  // namespace eses::detail::verify
