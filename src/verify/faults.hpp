#pragma once
/// What is wrong with a point or an edge of a result, by the definition.

#include <string>

#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "verify/definition.hpp"

namespace eses::detail::verify {

/// Empty if nothing is wrong, else a line that names the point. A point is wrong if it is farther
/// than 1e-6 angstrom on the other side of the surface, whichever of the centres that are
/// accessible in doubt count as accessible: see `Access`.
std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside);

/// Empty if nothing is wrong, else a line that names the edge. Checks that its ends are on their
/// sides, that the crossing lies on the edge and on the surface, that the normal leads to an
/// accessible centre where a probe touches the atoms, that the crossing is on the patch of these
/// atoms, and that all points between the crossing and the outside end are outside.
std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Crossing& crossing);

/// How far the crossing is from where another patch is as near, angstrom; 0.02 probe radii
/// if none is near. The normal is believed.
double distance_to_seam(CentreSearch& search, const Crossing& crossing);

}  // namespace eses::detail::verify
