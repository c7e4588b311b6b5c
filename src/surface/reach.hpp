#pragma once
/// The atoms that matter to a part of space.

#include <algorithm>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "surface/neighbors.hpp"

namespace eses::detail {

/// What happens in a box depends on the patches of atoms with |x - center| < radius + 2 probe for
/// an x in it. The arcs that bound the faces of these are found from either of their two atoms, so
/// all whose SAS spheres meet theirs are counted in.
struct Reach {
  Box box;
  double probe_radius = 0;
  double max_radius = 0;  ///< of the atoms whose patches matter in the box

  bool holds(const Atom& atom) const {
    const double distance = atom.radius + 2 * max_radius + 4 * probe_radius + look_up_slack;
    return squared_distance(box, atom.center) <= distance * distance;
  }
};

inline Reach make_reach(std::span<const Atom> atoms, const Box& box, double probe_radius) {
  Reach reach{box, probe_radius, 0};
  for (const Atom& atom : atoms) {
    const double distance = atom.radius + 2 * probe_radius + look_up_slack;
    if (squared_distance(box, atom.center) <= distance * distance)
      reach.max_radius = std::max(reach.max_radius, atom.radius);
  }
  return reach;
}

}  // namespace eses::detail
