#pragma once
/// Areas by residue and by chain, as CSV (RFC 4180, but with plain newlines).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atom_labels.hpp"

namespace eses {

/// Atoms that belong together, and the sum of their areas (square angstrom).
struct ResidueArea {
  std::string_view chain, number, name;  ///< see AtomLabel
  std::int64_t atoms = 0;
  double area = 0;
};

struct ChainArea {
  std::string_view chain;
  std::int64_t residues = 0;
  std::int64_t atoms = 0;
  double area = 0;
};

/// A residue for each run of atoms with the same chain, number and name, in the order of the file.
/// Views of `labels`, of which there must be as many as areas.
std::vector<ResidueArea> areas_by_residue(std::span<const AtomLabel> labels,
                                          std::span<const double> areas);

/// A chain for each label, in the order in which they come first: what a file lists behind the
/// last chain belongs to the chain that it names.
std::vector<ChainArea> areas_by_chain(std::span<const ResidueArea> residues);

/// residue_area.csv: `chain,residue_number,residue,atoms,area`
std::string residue_table(std::span<const ResidueArea> residues);

/// chain_area.csv: `chain,residues,atoms,area`
std::string chain_table(std::span<const ChainArea> chains);

}  // namespace eses
