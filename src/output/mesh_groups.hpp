#pragma once
/// Chains and residues of atoms, as a mesh names and numbers them.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "input/residue_runs.hpp"
#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail::mesh {

/// Numbers of an atom's chain and residue in a mesh file, from 0.
struct GroupNumbers {
  std::uint32_t chain = 0, residue = 0;
};

/// The chains and residues of a file.
struct GroupNames {
  bool are_known = false;  ///< whether the file has labels
  /// In the order of their numbers. Only the process that writes the mesh has them.
  std::vector<AtomLabel> chains, residues;

  /// Returns the estimated memory of numbering in bytes: the numbers of the atoms, and temporary
  /// lists of the first atoms of groups.
  static double memory_bytes(double atoms, double groups) {
    return sizeof(GroupNumbers) * atoms + 2 * list_growth * sizeof(AtomIndex) * groups;
  }
};

/// Numbers the chains and residues of atoms from 0 in the order of their first occurrence, and sets
/// the numbers of each atom. A chain is a chain name; a residue is a combination of chain name,
/// residue number and residue name. Names are compared as truncated by truncated_name.
GroupNames number_groups(const ResidueRuns& runs, std::vector<GroupNumbers>& of_atom);

/// Returns the beginning of a name, as written to a mesh file. Names are truncated because PLY
/// readers limit the length of lines.
inline std::string_view truncated_name(std::string_view name) {
  constexpr std::size_t max_name_length = 64;  // characters
  return name.substr(0, max_name_length);
}

/// Returns a residue as a mesh file names it, such as `LYS 12 A`.
inline std::string residue_text(const AtomLabel& label) {
  return formatted("{} {} {}", truncated_name(label.residue), truncated_name(label.residue_number),
                   truncated_name(label.chain));
}

}  // namespace eses::detail::mesh
