#pragma once
/// Numbers of chains and residues, as a mesh has them, where no process has all labels.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "distributed/processes.hpp"
#include "eses/atoms.hpp"
#include "io/residue_runs.hpp"
#include "mesh/atom_groups.hpp"

namespace eses::detail {

/// Numbers of keys, from 0 in the order in which the keys come first, processes by rank.
struct KeyNumbers {
  std::vector<std::uint32_t> of_key;
  std::vector<std::size_t> own;  ///< the keys that come first in this process, ascending
  std::uint32_t first = 0;       ///< number of the first of these
};

/// Numbers keys that differ from each other; to be called by all processes. One process, chosen by
/// the key's hash, finds out which process has a key first.
KeyNumbers number_keys(std::span<const std::string> keys, const Processes& processes);

/// The chains and residues that come first in the part of the file that this process has read.
struct GroupNames {
  bool are_known = false;                            ///< the same in all processes
  std::vector<AtomLabel> chains, residues;           ///< by number, from the first one on
  std::uint32_t first_chain = 0, first_residue = 0;  ///< numbers of the first ones
};

struct GroupNumbering {
  GroupNames names;
  std::vector<mesh::GroupNumbers> of_atom;  ///< of the atoms of `runs`
};

/// Numbers the chains and residues of the molecule as mesh::number_labels does; to be called by all
/// processes, with consecutive parts of the molecule by rank.
GroupNumbering number_groups(const ResidueRuns& runs, const Processes& processes);

}  // namespace eses::detail
