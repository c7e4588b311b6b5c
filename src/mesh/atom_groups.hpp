#pragma once
/// Chains and residues as numbers.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "eses/atom_labels.hpp"
#include "eses/atoms.hpp"

namespace eses::mesh {

/// Numbered from 0 in the order in which they come in the file. Names are not copied: they are
/// those of the first atom.
struct AtomGroups {
  bool are_known = false;
  std::span<const AtomLabel> labels;      ///< by atom
  std::vector<std::uint32_t> chain_of;    ///< by atom
  std::vector<std::uint32_t> residue_of;  ///< by atom
  std::vector<AtomIndex> chains;          ///< by chain: its first atom
  std::vector<AtomIndex> residues;        ///< by residue: its first atom
};

/// All atoms with the same chain are in one chain; those with the same chain, number and name of
/// residue in one residue; as far as names are written. Keeps a view of `labels`.
AtomGroups group_atoms(std::span<const AtomLabel> labels);

/// What is written of a name: readers of PLY files have room for lines of some length only.
inline std::string_view written_name(std::string_view name) {
  constexpr std::size_t longest_name = 64;  // characters
  return name.substr(0, longest_name);
}

}  // namespace eses::mesh
