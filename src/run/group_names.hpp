#pragma once
/// Chains and residues of atoms, as a mesh names and numbers them.

#include <cstdint>
#include <vector>

#include "eses/atoms.hpp"
#include "input/residue_runs.hpp"
#include "output/mesh_groups.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// The chains and residues of a file.
struct GroupNames {
  bool are_known = false;  ///< whether the file has labels
  /// In the order of their numbers. Only the process that writes the mesh has them.
  std::vector<AtomLabel> chains, residues;

  /// Returns the estimated memory of numbering in bytes: the numbers of the atoms, and temporary
  /// lists of the first atoms of groups.
  static double memory_bytes(double atoms, double groups) {
    return sizeof(mesh::GroupNumbers) * atoms + 2 * list_growth * sizeof(AtomIndex) * groups;
  }
};

/// Numbers the chains and residues of atoms as mesh::number_labels does. Sets the numbers of each
/// atom.
GroupNames number_groups(const ResidueRuns& runs, std::vector<mesh::GroupNumbers>& of_atom);

}  // namespace eses::detail
