#pragma once
/// The atoms that matter to a part of space.

#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "surface/neighbors.hpp"

namespace eses {

/// What happens in a box depends on the patches of atoms with |x - center| < radius + 2 probe for
/// an x in it. The arcs that bound the faces of these are found from either of their two atoms, so
/// all whose SAS spheres meet theirs are counted in.
struct Reach {
  Box box;
  double probe_radius = 0;
  double largest_radius = 0;  ///< of all atoms

  bool holds(const Atom& atom) const {
    constexpr double slack = 1e-3;  // angstrom: far more than rounding and tolerances make of it
    const double distance = atom.radius + 2 * largest_radius + 4 * probe_radius + slack;
    return squared_distance(box, atom.center) <= distance * distance;
  }
};

}  // namespace eses
