#pragma once
/// Chains and residues of a molecule as a mesh numbers them, of which no process has all.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "distributed/atom_share.hpp"
#include "distributed/processes.hpp"
#include "eses/atom_labels.hpp"
#include "mesh/atom_groups.hpp"

namespace eses {

/// Numbers of keys, from 0 in the order in which they come first in any process, by rank.
struct SharedNumbers {
  std::vector<std::uint32_t> of_key;
  std::vector<std::size_t> own;  ///< the keys that come first in this process, ascending
  std::uint32_t first = 0;       ///< number of the first of these
};

/// To be called by all processes, with keys that differ from each other. For each key one process,
/// known by its hash, finds out who has it first.
SharedNumbers number_jointly(std::span<const std::string> keys, const Processes& processes);

/// Those that come first in the file with the atoms of one process.
struct OwnGroups {
  bool are_known = false;                            ///< in all processes or none
  std::vector<AtomLabel> chains, residues;           ///< their names
  std::uint32_t first_chain = 0, first_residue = 0;  ///< what the first of them is numbered
};

/// To be called by all processes: numbers the chains and residues of the molecule as
/// `mesh::group_atoms` does, and tells the share's atoms theirs.
OwnGroups number_groups(AtomShare& share, const Processes& processes);

/// Of atoms with these numbers, whose names others may have.
mesh::AtomGroups groups_of(std::span<const GroupNumbers> numbers, bool are_known);

}  // namespace eses
