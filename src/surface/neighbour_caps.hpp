#pragma once
/// The caps that neighbours cut from the SAS spheres of atoms.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/cap_list.hpp"
#include "geometry/float_spheres.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Scratch memory of the search for neighbours, one per thread, and its results.
struct NeighbourScratch {
  std::vector<Atom> atoms;              ///< all atoms that are visited
  std::vector<AtomIndex> found;         ///< atoms near a group of atoms that is looked up together
  std::vector<AtomIndex> near;          ///< atoms of `found` that are not contained in another one
  SphereList near_spheres;              ///< SAS spheres of `near`
  FloatSpheres near_floats;             ///< the same in single precision
  FloatSpheres group_floats;            ///< those near a smaller group
  std::vector<std::int32_t> near_atom;  ///< positions in `near` of those near one atom
  SpherePositions neighbours;           ///< position in `near` of each cap of `caps`
  CapList caps;                         ///< caps of one atom

  /// The atom of cap `k` of `caps`.
  AtomIndex neighbour(std::uint32_t k) const {
    return near[static_cast<std::size_t>(neighbours.at[k])];
  }
};

/// Calls `visit(i)` for each of the atoms, with the neighbours of its group in `scratch`. It is
/// faster if consecutive atoms are near each other. There are no neighbours if no atom of a large
/// group needs patches.
void for_each_with_neighbours(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                              NeighbourScratch& scratch,
                              const std::function<void(AtomIndex)>& visit);

/// Replaces `scratch.caps` by the caps of an atom that is being visited.
void collect_caps(const SurfaceModel& surface, AtomIndex i, NeighbourScratch& scratch);

}  // namespace eses::detail
