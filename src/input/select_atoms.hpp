#pragma once
/// Selection of the atoms of a structure by the user's options.

#include <cstdint>
#include <gemmi/model.hpp>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Returns the number of atoms read from records of the kind of `residue`: water, other HETATM
/// records, or ATOM records.
std::uint64_t& record_count(StructureReport& report, const gemmi::Residue& residue);

/// Takes the selected model out of the structure and removes the atoms that are not selected.
/// Removes hydrogens if `with_hydrogens` is false, independently of `options`. Fills the counts of
/// `report`. Throws Error, with `file`, if there is no such model, chain or alternate location.
gemmi::Model select_atoms(gemmi::Structure& structure, const StructureOptions& options,
                          bool with_hydrogens, std::string_view file, StructureReport& report);

}  // namespace eses::detail
