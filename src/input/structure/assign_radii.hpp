#pragma once
/// Assignment of radii to the atoms of a structure.

#include <functional>
#include <vector>

#include "input/radii_set.hpp"
#include "input/read_structure.hpp"
#include "input/structure/structure_atoms.hpp"

namespace eses::detail {

/// Adds the atoms with their radii, their lines and, if the options request them, their labels to
/// `result`, and completes its report and its diagnostics. `guessed` has the serial numbers of the
/// atoms whose elements follow from their names. Calls the check and `after_part` after each part.
/// Throws Error with the names of atoms without a radius.
void assign_radii(const std::vector<StructureAtom>& atoms, const RadiiSet& radii,
                  const std::vector<int>& guessed, const StructureText& text, AtomFile& result,
                  const std::function<void(AtomFile& atoms)>& after_part);

}  // namespace eses::detail
