#pragma once
/// Areas by residue and by chain, as CSV (RFC 4180, but with plain newlines).

#include <cstdint>
#include <span>
#include <string_view>

#include "eses/atom_labels.hpp"
#include "io/text_pieces.hpp"

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

/// residue_area.csv: `chain,residue_number,residue,atoms,area`. A residue for each run of atoms
/// with the same chain, number and name, in the order of the file; as many areas as labels.
void write_residue_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                         const TextSink& sink);

/// chain_area.csv: `chain,residues,atoms,area`. A chain for each label, in the order in which they
/// come first: what a file lists behind the last chain belongs to the chain that it names.
void write_chain_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                       const TextSink& sink);

}  // namespace eses
