#pragma once
/// A molecule and its probe: all that the geometry of the surface follows from.

#include <optional>
#include <span>
#include <utility>

#include "geometry/contact_circle.hpp"
#include "surface/cell_list.hpp"
#include "surface/molecule.hpp"
#include "surface/neighbors.hpp"
#include "surface/reach.hpp"

namespace eses::detail {

struct SurfaceModel {
  Molecule molecule;
  std::span<const Atom> atoms;  ///< the molecule's
  double probe_radius = 0;      ///< angstrom
  /// If only a part of space is looked at: other atoms need no patches.
  std::optional<Reach> reach;

  SurfaceModel(Molecule of, double probe)
      : molecule(std::move(of)), atoms(molecule.atoms()), probe_radius(probe) {}

  /// Only what happens in `box` will be asked.
  void confine_to(const Box& box) { reach = make_reach(atoms, box, probe_radius); }

  bool needs_patches(AtomIndex i) const { return !reach || reach->holds(atoms[i]); }

  const AtomTree& tree() const { return molecule.tree(); }
  const CellList& cells() const { return molecule.cells(); }

  SasSphere sas_sphere(AtomIndex i) const {
    return {atoms[i].center, atoms[i].radius + probe_radius};
  }
};

}  // namespace eses::detail
