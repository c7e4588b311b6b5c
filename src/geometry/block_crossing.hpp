#pragma once
/// Crossings of grid edges in a compact form, relative to a block.

#include <array>
#include <cstdint>

#include "eses/atoms.hpp"
#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "eses/vec3.hpp"

namespace eses::detail {

/// A crossing of the surface with an edge that has one end inside and one outside: the one nearest
/// to the outside end. The y and z of the edge follow from the position in a list that is sorted by
/// row.
struct BlockCrossing {
  double coordinate = 0;             ///< coordinate along the edge's axis, angstrom
  Vec3 normal;                       ///< outward unit normal
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; the first `atom_count` are set
  std::uint16_t x = 0;    ///< index of the edge's lower end, relative to the block's first point
  std::uint8_t axis = 0;  ///< direction of the edge: 0, 1, 2 for x, y, z
  std::uint8_t atom_count : 7 = 0;       ///< 1 on convex, 2 on saddle, 3 on concave patches
  std::uint8_t lower_is_inside : 1 = 0;  ///< whether the lower end is the inside one
};

/// Returns the crossing in the coordinates of the whole grid. `row_start` is the block's first
/// point in the row of the edge's lower end.
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
