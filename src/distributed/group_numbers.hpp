#pragma once
/// Distributed numbering of chains and residues for meshes.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "distributed/processes.hpp"
#include "eses/atoms.hpp"
#include "input/residue_runs.hpp"
#include "output/mesh_groups.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// Numbers of keys, from 0 in the order of their first occurrence, by rank and then by index.
struct KeyNumbers {
  std::vector<std::uint32_t> of_key;    ///< number of each key of this process
  std::vector<std::size_t> first_here;  ///< indices of the keys that occur first here, ascending
  std::uint32_t first = 0;              ///< number of the first of these
};

/// Numbers the distinct keys of each process. All processes must call it. The hash of a key
/// determines the process that finds the first occurrence of the key.
KeyNumbers number_keys(std::span<const std::string> keys, const Processes& processes);

/// The chains and residues whose first atom is in the part of the file that this process has read.
struct GroupNames {
  bool are_known = false;  ///< whether the file has labels; the same in all processes
  std::vector<AtomLabel> chains, residues;           ///< in the order of their numbers
  std::uint32_t first_chain = 0, first_residue = 0;  ///< numbers of the first ones
};

/// The numbers of chains and residues.
struct GroupNumbering {
  GroupNames names;
  std::vector<mesh::GroupNumbers> of_atom;  ///< numbers of each atom of this process

  /// Returns the estimated memory in bytes, with the temporary lists of the first atoms of groups.
  static double memory_bytes(double atoms, double groups) {
    return sizeof(mesh::GroupNumbers) * atoms + 2 * list_growth * sizeof(AtomIndex) * groups;
  }
};

/// Numbers the chains and residues of the molecule as mesh::number_labels does. All processes must
/// call it with consecutive parts of the molecule by rank.
GroupNumbering number_groups(const ResidueRuns& runs, const Processes& processes);

}  // namespace eses::detail
