#pragma once
/// Areas by residue and by chain, as CSV (RFC 4180, but with plain newlines).

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atom_labels.hpp"
#include "io/text_pieces.hpp"

namespace eses {

/// Atoms that belong together, and the sum of their areas (square angstrom).
struct ResidueArea {
  std::string_view chain, number, name;  ///< see AtomLabel
  std::int64_t atoms = 0;
  double area = 0;

  /// Of further atoms, in their order.
  void add(std::span<const double> areas);
};

struct ChainArea {
  std::string_view chain;
  std::int64_t residues = 0;
  std::int64_t atoms = 0;
  double area = 0;
};

/// Whether atoms that follow each other are of the same residue.
bool is_same_residue(const AtomLabel& a, const AtomLabel& b);

/// Adds up residues, and chains that are added up already, by chain.
class ChainAreas {
 public:
  ChainAreas() = default;
  ChainAreas(ChainAreas&&) = default;
  ChainAreas& operator=(ChainAreas&&) = default;

  void add(const ResidueArea& residue) { add({residue.chain, 1, residue.atoms, residue.area}); }
  void add(const ChainArea& part);
  /// In the order in which they came first.
  std::span<const ChainArea> chains() const { return chains_; }

 private:
  std::vector<ChainArea> chains_;
  std::map<std::string, std::size_t, std::less<>> places_;  // whose names the chains have
};

inline constexpr char residue_table_header[] = "chain,residue_number,residue,atoms,area\n";
void append_residue(TextPieces& text, const ResidueArea& residue);

/// residue_area.csv: `chain,residue_number,residue,atoms,area`. A residue for each run of atoms
/// with the same chain, number and name, in the order of the file; as many areas as labels.
void write_residue_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                         const TextSink& sink);

/// chain_area.csv: `chain,residues,atoms,area`. A chain for each label, in the order in which they
/// come first: what a file lists behind the last chain belongs to the chain that it names.
void write_chain_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                       const TextSink& sink);
void write_chain_table(std::span<const ChainArea> chains, const TextSink& sink);

}  // namespace eses
