#pragma once
/// Where a grid edge crosses the solvent excluded surface.

#include <array>
#include <cstdint>

#include "eses/atoms.hpp"
#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "eses/vec3.hpp"

namespace eses::detail {

/// Where an edge with one end inside and one outside crosses the surface: the last crossing on the
/// way from the inside end to the outside end.
struct BlockCrossing {
  double coordinate = 0;             ///< of the crossing along the edge's axis, angstrom
  Vec3 normal;                       ///< outward unit normal
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; the first `atom_count` count
  std::uint16_t x = 0;               ///< of the edge's lower point, from the block's first point
  std::uint8_t axis = 0;             ///< 0, 1, 2: the edge runs along x, y, z
  std::uint8_t atom_count : 7 = 0;   ///< 1 convex, 2 saddle, 3 concave
  std::uint8_t lower_is_inside : 1 = 0;  ///< whether the lower point is the inside end
};

/// Returns the crossing with its place in the grid. `row_start` is the first point of the block in
/// the row of the edge's lower end.
inline Crossing to_crossing(const Grid& grid, const GridIndex& row_start,
                            const BlockCrossing& found) {
  Crossing crossing;
  crossing.lower = {row_start[0] + found.x, row_start[1], row_start[2]};
  crossing.position = grid.point(crossing.lower);
  crossing.position[found.axis] = found.coordinate;
  crossing.normal = found.normal;
  crossing.atoms = found.atoms;
  crossing.atom_count = found.atom_count;
  crossing.axis = found.axis;
  crossing.lower_is_inside = found.lower_is_inside != 0;
  return crossing;
}

}  // namespace eses::detail
