#pragma once
/// The atoms that influence a part of space.

#include <algorithm>
#include <span>

#include "geometry/box.hpp"
#include "surface/atom_tree.hpp"

namespace eses::detail {

/// The atoms whose patches are needed for the points x of a box. The surface there depends on the
/// patches of atoms with |x - center| < radius + 2 probe_radius. The arcs that bound the faces of
/// such an atom belong to either of two atoms, so the atoms whose SAS spheres meet that of such an
/// atom are needed as well. Lengths are in angstrom.
struct Reach {
  Box box;
  double probe_radius = 0;
  double max_radius = 0;  ///< maximum radius of the atoms whose patches influence the box

  /// Returns whether the patches of the atom are needed.
  bool contains(const Atom& atom) const {
    const double distance = atom.radius + 2 * max_radius + 4 * probe_radius + look_up_slack;
    return squared_distance(box, atom.center) <= distance * distance;
  }
};

/// Returns the reach of a box.
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
