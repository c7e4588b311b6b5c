#pragma once
/// Selection of the atoms of a structure by the user's options.

#include <cstdint>
#include <gemmi/model.hpp>
#include <string_view>

#include "eses/read_atoms.hpp"
#include "input/structure/parse_structure.hpp"

namespace eses::detail {

/// Returns whether a residue is a water molecule. Some of the names that programs of molecular
/// dynamics use for water are names of other molecules in the PDB, so the elements count as well.
bool is_water(const gemmi::Residue& residue);

/// Returns the number of atoms read from records of the kind of `residue`: water, other HETATM
/// records, or ATOM records.
std::uint64_t& record_count(StructureReport& report, const gemmi::Residue& residue);

/// Removes the atoms that are not selected from the model. Removes hydrogens if `with_hydrogens` is
/// false, independently of `options`. Fills the counts of `report`. Throws Error, with `file`, if
/// there is no such chain or alternate location.
void select_atoms(ParsedStructure& parsed, const StructureOptions& options, bool with_hydrogens,
                  std::string_view file, StructureReport& report);

}  // namespace eses::detail
