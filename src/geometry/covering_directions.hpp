#pragma once
/// A fixed set of directions whose spherical patches cover the sphere.

#include <cstddef>
#include <vector>

#include "eses/vec3.hpp"

namespace eses::detail {

/// Every direction of space is within `radius` (radians) of one of `directions` (unit vectors).
struct CoveringDirections {
  std::vector<Vec3> directions;
  double radius = 0;
};

/// Vertices of an icosahedron whose edges are divided by `frequency`: 10 frequency^2 + 2 of them.
/// The radius is the largest circumradius of the triangles, which tile the sphere; they are acute,
/// so each of their points is as near as that to a corner.
CoveringDirections make_covering_directions(int frequency);

}  // namespace eses::detail
