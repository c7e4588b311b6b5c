#pragma once
/// Numbering of chains and residues.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "system/formatted.hpp"

namespace eses::detail::mesh {

/// Numbers of an atom's chain and residue in a mesh file, from 0.
struct GroupNumbers {
  std::uint32_t chain = 0, residue = 0;
};

/// Numbers of the chains and residues of labels, from 0 in the order of their first occurrence.
struct LabelNumbers {
  std::vector<std::uint32_t> chain_of, residue_of;  ///< by label
  std::vector<AtomIndex> chains, residues;          ///< by number: the first label that has it
};

/// Numbers chains and residues. A chain is a chain name; a residue is a combination of chain name,
/// residue number and residue name. Names are compared as truncated by truncated_name.
LabelNumbers number_labels(std::span<const AtomLabel> labels);

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
