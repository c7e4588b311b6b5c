#pragma once
/// The mesh's vertices.

#include <array>
#include <cstddef>
#include <cstdint>

#include "eses/grid.hpp"
#include "grid/block_crossing.hpp"

namespace eses::detail::mesh {

struct Vertex {
  Vec3 position;                     ///< angstrom
  Vec3 normal;                       ///< outward unit normal
  std::uint8_t patch = 1;            ///< 1 convex, 2 saddle, 3 concave
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; there are `patch` of them

  AtomIndex first_atom() const { return atoms[0]; }
};

/// A crossing that is nearer than this to a grid point coincides with it.
inline constexpr double coincidence = 1e-6;  // of the spacing
/// Vertices stay so far away from a grid point with which their crossings coincide.
inline constexpr double clearance = 1e-4;  // of the spacing

/// The vertex on an edge of the grid that starts at the point `lower`: its crossing. If that
/// coincides with a grid point, so may those of other edges there, and triangles would have no
/// area, or sheets of the surface touch; so it stands a little off, on its edge.
Vertex make_vertex(const Grid& grid, const GridIndex& lower, const BlockCrossing& crossing);

}  // namespace eses::detail::mesh
