#pragma once
/// A fixed set of directions whose surrounding caps cover the unit sphere.

#include <array>
#include <vector>

#include "eses/vec3.hpp"

namespace eses::detail {

/// Directions as unit vectors. Each direction in space is within `radius` (radians) of one of them.
struct CoveringDirections {
  std::vector<Vec3> directions;
  double radius = 0;
};

/// Returns the 20 triangles of an icosahedron, as vectors of equal length to their corners.
std::vector<std::array<Vec3, 3>> icosahedron_triangles();

/// Returns the 10 frequency^2 + 2 vertices of an icosahedron whose edges are divided into
/// `frequency` parts. The radius is the maximum circumradius of the triangles, which tile the
/// sphere. The triangles are acute, so each point of a triangle is within that radius of a corner.
CoveringDirections make_covering_directions(int frequency);

}  // namespace eses::detail
