#pragma once
/// The tables of mmCIF documents that are read. This header is valid C++17, for the reason given in
/// mmcif_text.cpp.

#include <cstdint>
#include <gemmi/cifdoc.hpp>
#include <gemmi/model.hpp>
#include <string>
#include <vector>

#include "eses/check.hpp"
#include "input/structure/parse_structure.hpp"

namespace eses::detail {

/// An error in an mmCIF text, before the name of the file is known.
struct MmcifError {
  std::uint64_t line = 0;  ///< line number, from 1; 0 if it is unknown
  std::string message;
};

/// Prefix of the tags of the table of atoms, in lower case as gemmi requires.
inline constexpr const char* atom_category = "_atom_site.";

/// Prefix of the tags of partial charges that Atomic Charge Calculator II and Mol* share.
inline constexpr const char* charge_category = "_sb_ncbr_partial_atomic_charges.";

/// Throws MmcifError if a table that `is_used` accepts lacks values or has the same tag twice.
void check_tables(const gemmi::cif::Block& block, bool (*is_used)(const std::string& tag));

/// The atoms of the chosen model.
struct AtomTable {
  std::vector<gemmi::Chain> chains;
  std::vector<int> guessed_elements;  ///< rows of atoms with elements by name, ascending
  std::vector<double> charges;        ///< of rows, NaN if unknown; empty if the file has none
  bool has_label_chains = false;      ///< whether the table has label_asym_id
};

/// Checks the table of atoms, whose rows are in `lines`, and returns those of the chosen model.
/// Their serial numbers are the rows, from 0. With ParseOptions::label_chains, chains have the
/// names of label_asym_id, and the segment of a residue is its chain in auth_asym_id. Throws
/// MmcifError if the table lacks a column or has an invalid value.
AtomTable read_atom_table(gemmi::cif::Block& block, const std::vector<std::uint64_t>& lines,
                          ModelList& models, const ParseOptions& options);

/// Returns whether read_assemblies needs the table of a tag.
bool is_assembly_tag(const std::string& tag);

/// Returns the assemblies of a data block in the order of the file. Only the assembly `chosen` has
/// generators. Throws MmcifError if its operators or tables are invalid. If `chosen` is empty,
/// returns the assemblies before the first invalid one, with their generators.
std::vector<gemmi::Assembly> read_assemblies(gemmi::cif::Block& block, const std::string& chosen);

}  // namespace eses::detail
