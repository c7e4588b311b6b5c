#pragma once
/// What is wrong with a point or an edge of a result, by the definition.

#include <string>

#include "eses/grid.hpp"
#include "grid/crossing.hpp"
#include "verify/definition.hpp"

namespace eses::detail::verify {

/// An edge that the surface cuts, as a result has it; `crossing.x` is ignored.
struct Edge {
  GridIndex lower{};  ///< its lower point
  Crossing crossing;

  Vec3 point(const Grid& grid) const {
    Vec3 x = grid.point(lower);
    x[crossing.axis] = crossing.coordinate;
    return x;
  }
  GridIndex inside() const { return crossing.lower_is_inside ? lower : upper(); }
  GridIndex outside() const { return crossing.lower_is_inside ? upper() : lower; }
  GridIndex upper() const {
    GridIndex point = lower;
    ++point[crossing.axis];
    return point;
  }
};

/// Empty if nothing is wrong, else a line that names the point. A point is wrong if it is farther
/// than 1e-6 angstrom on the other side of the surface, whichever of the centres that are
/// accessible in doubt count as accessible: see `Access`.
std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside);

/// Empty if nothing is wrong, else a line that names the edge. Checks that its ends are on their
/// sides, that the crossing lies on the edge and on the surface, that the normal leads to an
/// accessible centre where a probe touches the atoms, that the crossing is on the patch of these
/// atoms, and that all points between the crossing and the outside end are outside.
std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Edge& edge);

/// How far the crossing is from where another patch is as near, angstrom; 0.02 probe radii
/// if none is near. The normal is believed.
double distance_to_seam(CentreSearch& search, const Grid& grid, const Edge& edge);

}  // namespace eses::detail::verify
