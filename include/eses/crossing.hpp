#pragma once
/// @file
/// Crossings of grid edges with the surface.

#include <array>
#include <cstdint>
#include <span>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"

namespace eses {

/// A crossing of the surface with a grid edge that has one end inside and one outside. If the
/// surface cuts the edge several times, it is the crossing that is nearest to the outside end.
/// Edges whose ends are both inside or both outside have no crossing.
struct Crossing {
  GridIndex lower{};  ///< Lower end of the edge, as indices in the whole grid.
  Vec3 position;      ///< Position of the crossing, in angstrom.
  Vec3 normal;        ///< Outward unit normal of the surface.
  /// Adjacent atoms, which are touched by the probe that touches the crossing. In ascending order;
  /// only the first `atom_count` elements are set.
  std::array<AtomIndex, 3> atoms{};
  /// Number of adjacent atoms: 1 on convex, 2 on saddle, 3 on concave patches.
  std::uint8_t atom_count = 0;
  std::uint8_t axis = 0;         ///< Direction of the edge: 0, 1, 2 for x, y, z.
  bool lower_is_inside = false;  ///< Whether the lower end of the edge is the inside one.

  /// The upper end of the edge.
  GridIndex upper() const {
    GridIndex point = lower;
    ++point[axis];
    return point;
  }
  /// The inside end of the edge.
  GridIndex inside_point() const { return lower_is_inside ? lower : upper(); }
  /// The outside end of the edge.
  GridIndex outside_point() const { return lower_is_inside ? upper() : lower; }
  /// The adjacent atoms.
  std::span<const AtomIndex> adjacent_atoms() const { return {atoms.data(), atom_count}; }
};

}  // namespace eses
