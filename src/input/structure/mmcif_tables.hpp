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

/// Checks the table of atoms and returns the chains of the chosen model. `parsed` has the lines of
/// its rows as sources, whose indices are the serial numbers of atoms, and gets their charges and
/// names of models. With ParseOptions::label_chains, chains have the names of label_asym_id, and
/// the segment of a residue is its chain in auth_asym_id. Throws MmcifError if the table lacks a
/// column or has an invalid value.
std::vector<gemmi::Chain> read_atom_table(gemmi::cif::Block& block, const ParseOptions& options,
                                          ParsedStructure& parsed);

}  // namespace eses::detail
