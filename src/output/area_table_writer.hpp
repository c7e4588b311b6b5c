#pragma once
/// Areas by residue, by chain and by atom, as CSV (RFC 4180, but with LF as line end).
///
/// residue_area.csv: `chain,residue_number,residue,atoms,area`. One line for each run of atoms with
/// the same chain, number and name, in the order of the file.
///
/// chain_area.csv: `chain,residues,atoms,area`. One line for each chain identifier, in the order of
/// first occurrence. Waters and ligands that a file lists after the last chain are counted with the
/// chain that they name.
///
/// atoms.csv: `serial,name,residue,residue_number,chain,element,radius,area`. One line for each
/// atom, in the order of the file.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "input/residue_runs.hpp"
#include "output/buffered_text.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// Returns a field of a CSV file, in quotation marks if it contains commas, quotation marks or line
/// ends.
std::string csv_field(std::string_view text);

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
  /// Returns the chains in the order of first occurrence.
  std::span<const ChainArea> chains() const { return chains_; }

  /// Returns the estimated memory in bytes of chains with names of this total length, including the
  /// messages between ranks.
  static double memory_bytes(double chains, double name_bytes) {
    constexpr double copies_of_name = 4;
    return (list_growth * sizeof(ChainArea) + 64 + 4 * sizeof(std::string)) * chains +
           copies_of_name * name_bytes;
  }

 private:
  std::vector<ChainArea> chains_;
  std::map<std::string, std::size_t, std::less<>> indices_;  // by name
};

/// Atoms of one residue, and the sum of their areas (square angstrom).
struct ResidueArea {
  AtomLabel label;
  std::int64_t atoms = 0;
  double area = 0;
};

/// The sums over the atoms that have been added so far. The last residue stays open, because the
/// next atoms may belong to it.
struct AreaTables {
  std::optional<ResidueArea> open;
  ChainAreas chains;
};

/// Appends the header line of residue_area.csv.
void append_residue_header(BufferedText& text);

/// Adds consecutive atoms with their areas. Appends a line of residue_area.csv for each residue
/// that ends.
void add_residues(AreaTables& tables, const ResidueRuns& runs, std::span<const double> areas,
                  BufferedText& text);

/// Ends the last residue and appends its line.
void end_residues(AreaTables& tables, BufferedText& text);

/// Appends the whole of chain_area.csv.
void append_chains(BufferedText& text, std::span<const ChainArea> chains);

/// The data of an atom in atoms.csv.
struct AtomRow {
  std::uint64_t serial = 0;  ///< number of the atom in the file, from 1
  AtomLabel label;
  double radius = 0;  ///< angstrom
  double area = 0;    ///< square angstrom
};

/// Appends the header line of atoms.csv.
void append_atom_header(BufferedText& text);

/// Appends a line of atoms.csv.
void append_atom(BufferedText& text, const AtomRow& atom);

/// Returns the expected length of atoms.csv for atoms whose names have this total length.
std::uint64_t typical_atom_table_bytes(std::uint64_t atoms, std::uint64_t name_bytes);

}  // namespace eses::detail
