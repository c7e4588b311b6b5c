#pragma once
/// Where a grid edge crosses the solvent excluded surface.

#include <array>
#include <cstdint>

#include "eses/atoms.hpp"
#include "eses/vec3.hpp"

namespace eses::detail {

/// Where an edge with one end inside and one outside crosses the surface: the last crossing on the
/// way from the inside end to the outside end.
struct Crossing {
  double coordinate = 0;             ///< of the crossing along the edge's axis, angstrom
  Vec3 normal;                       ///< outward unit normal
  std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms, ascending; the first `atom_count` count
  std::uint16_t x = 0;               ///< of the edge's lower point, from the block's first point
  std::uint8_t axis = 0;             ///< 0, 1, 2: the edge runs along x, y, z
  std::uint8_t atom_count : 7 = 0;   ///< 1 convex, 2 saddle, 3 concave
  std::uint8_t lower_is_inside : 1 = 0;  ///< whether the lower point is the inside end
};

}  // namespace eses::detail
