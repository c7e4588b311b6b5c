#pragma once
/// Chains and residues as numbers.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail::mesh {

/// An atom's chain and residue as a mesh numbers them.
struct GroupNumbers {
  std::uint32_t chain = 0, residue = 0;
};

/// The chains and residues of atoms, if they are known.
struct AtomGroups {
  bool are_known = false;
  std::span<const GroupNumbers> of_atom;
  std::uint64_t chain_count = 0, residue_count = 0;  ///< of the whole molecule
};

/// Chains and residues of labels, numbered from 0 in the order in which they come first.
struct LabelNumbers {
  std::vector<std::uint32_t> chain_of, residue_of;  ///< by label
  std::vector<AtomIndex> chains, residues;          ///< by number: the first label that has it
};

/// Labels with the same chain are in one chain; those with the same chain, residue number and
/// residue name in one residue; as far as names are written.
LabelNumbers number_labels(std::span<const AtomLabel> labels);

/// What is written of a name: readers of PLY files have room for lines of some length only.
inline std::string_view written_name(std::string_view name) {
  constexpr std::size_t longest_name = 64;  // characters
  return name.substr(0, longest_name);
}

}  // namespace eses::detail::mesh
