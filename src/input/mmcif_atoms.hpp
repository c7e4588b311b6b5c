#pragma once
/// The table of atoms of mmCIF documents.

#include <cstdint>
#include <gemmi/cifdoc.hpp>
#include <gemmi/model.hpp>
#include <vector>

#include "input/checker.hpp"

namespace eses::detail {

/// Prefix of the tags of the table of atoms, in lower case as gemmi requires.
inline constexpr const char* atom_category = "_atom_site.";

/// Converts the table of atoms to models. `lines` has the line number of each row, which becomes
/// the serial number of the atom. The types of entities of the residues remain unknown. Calls
/// `checker` repeatedly. Throws MmcifError if the table lacks a column or has an invalid value.
std::vector<gemmi::Model> read_models(const gemmi::cif::Loop& table,
                                      const std::vector<std::uint64_t>& lines, Checker& checker);

}  // namespace eses::detail
