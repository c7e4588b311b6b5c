#pragma once
/// Chains and residues as numbers.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eses/atom_labels.hpp"

namespace eses::mesh {

/// Numbered from 0 in the order in which they come in the file.
struct AtomGroups {
  std::vector<std::uint32_t> chain_of;    ///< by atom
  std::vector<std::uint32_t> residue_of;  ///< by atom
  std::vector<std::string> chains;        ///< names
  std::vector<std::string> residues;      ///< name, number and chain, with blanks between

  bool empty() const { return chain_of.empty(); }
};

/// All atoms with the same chain are in one chain; those with the same chain, number and name of
/// residue in one residue.
AtomGroups group_atoms(std::span<const AtomLabel> labels);

}  // namespace eses::mesh
