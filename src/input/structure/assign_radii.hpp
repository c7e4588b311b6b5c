#pragma once
/// Assignment of radii to the atoms of a structure.

#include <vector>

#include "input/radii_set.hpp"
#include "input/read_structure.hpp"
#include "input/structure/structure_atoms.hpp"

namespace eses::detail {

/// Adds the atoms with their radii, their lines and, if the options request them, their labels to
/// `result` or `store`, and completes its report and its diagnostics. Throws Error with the names
/// of atoms without a radius.
void assign_radii(const std::vector<StructureAtom>& atoms, const ParsedStructure& parsed,
                  const RadiiSet& radii, const StructureText& text, AtomFile& result,
                  const NameStore& store);

}  // namespace eses::detail
