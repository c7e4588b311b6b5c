#pragma once
/// What is wrong with a point or an edge of a result, by the definition.

#include <string>

#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "verify/definition.hpp"

namespace eses::verify {

/// What a result says of an edge that the surface cuts: `crossing.x` is not looked at.
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

/// Empty if nothing is wrong, else a line that names the point. Within 1e-7 angstrom of the surface
/// a point may be called either.
std::string fault_of_point(CentreSearch& search, const Grid& grid, const GridIndex& point,
                           bool is_inside);

/// Empty if nothing is wrong, else a line that names the edge: its ends are as it says, the
/// crossing lies on it and on the surface, the normal leads to the nearest accessible centre, at
/// which a probe touches the atoms, and all between the crossing and the outside end is outside.
std::string fault_of_edge(CentreSearch& search, const Grid& grid, const Edge& edge);

/// How far the crossing is from where another patch is as near, angstrom; 0.02 probe radii
/// if none is near. The normal is believed.
double distance_to_seam(CentreSearch& search, const Grid& grid, const Edge& edge);

}  // namespace eses::verify
