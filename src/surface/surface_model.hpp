#pragma once
/// A molecule and a probe radius, which define the surface.

#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "geometry/contact_circle.hpp"
#include "surface/atom_tree.hpp"
#include "surface/cell_list.hpp"
#include "surface/molecule.hpp"
#include "surface/reach.hpp"

namespace eses::detail {

class CavityMap;

/// The definition of a surface: its atoms and the probe radius.
struct SurfaceModel {
  Molecule molecule;
  std::span<const Atom> atoms;  ///< atoms of `molecule`
  double probe_radius = 0;      ///< angstrom
  /// The part of space that is computed; all of it if empty. Atoms outside of it need no patches.
  std::optional<Reach> reach;
  /// Whether accessibility has the slack of tolerance::accessible, and arcs have a minimum length.
  /// Without slack, decisions on the three contact circles at a placement agree unless rounding
  /// decides, and a probe that just fits may be rejected.
  bool has_slack = true;
  /// The cavities of the molecule, if some component is filled; else null. Patches of filled
  /// components are left out.
  std::shared_ptr<const CavityMap> cavities;

  SurfaceModel(Molecule of, double probe)
      : molecule(std::move(of)), atoms(molecule.atoms()), probe_radius(probe) {}

  /// Restricts the computation to the points in `box`.
  void confine_to(const Box& box) { reach = make_reach(atoms, box, probe_radius); }

  /// Returns whether the patches of an atom are needed.
  bool needs_patches(AtomIndex i) const { return !reach || reach->contains(atoms[i]); }

  const AtomTree& tree() const { return molecule.tree(); }
  const CellList& cells() const { return molecule.cells(); }

  /// Returns the SAS sphere of an atom.
  SasSphere sas_sphere(AtomIndex i) const {
    return {atoms[i].center, atoms[i].radius + probe_radius};
  }
};

}  // namespace eses::detail
