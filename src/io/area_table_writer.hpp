#pragma once
/// Areas by residue and by chain, as CSV (RFC 4180, but with plain newlines).
///
/// residue_area.csv: `chain,residue_number,residue,atoms,area`. A residue for each run of atoms
/// with the same chain, number and name, in the order of the file.
///
/// chain_area.csv: `chain,residues,atoms,area`. A chain for each label, in the order in which they
/// come first: what a file lists behind the last chain belongs to the chain that it names.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/buffered_text.hpp"
#include "io/residue_runs.hpp"

namespace eses::detail {

struct ChainArea {
  std::string_view chain;
  std::int64_t residues = 0;
  std::int64_t atoms = 0;
  double area = 0;  ///< square angstrom
};

/// Adds up areas by chain.
class ChainAreas {
 public:
  ChainAreas() = default;
  ChainAreas(ChainAreas&&) = default;
  ChainAreas& operator=(ChainAreas&&) = default;

  void add(const ChainArea& part);
  /// In the order in which they came first.
  std::span<const ChainArea> chains() const { return chains_; }

 private:
  std::vector<ChainArea> chains_;
  std::map<std::string, std::size_t, std::less<>> places_;  // whose names the chains have
};

/// Atoms of one residue, and the sum of their areas (square angstrom).
struct ResidueArea {
  AtomLabel label;
  std::int64_t atoms = 0;
  double area = 0;
};

/// The sums over the atoms that have been added so far. The last residue stays open, as it may go
/// on with the next atoms.
struct AreaTables {
  std::optional<ResidueArea> open;
  ChainAreas chains;
};

/// Appends the first line of residue_area.csv.
void append_residue_header(BufferedText& text);

/// Adds further atoms, in their order, with an area for each. Appends a line of residue_area.csv
/// for each residue that ends.
void add_residues(AreaTables& tables, const ResidueRuns& runs, std::span<const double> areas,
                  BufferedText& text);

/// Ends the last residue and appends its line.
void end_residues(AreaTables& tables, BufferedText& text);

/// All of chain_area.csv.
void write_chain_table(std::span<const ChainArea> chains, const TextSink& sink);

}  // namespace eses::detail
