#pragma once
/// Biological assemblies: copies of chains by operators.

#include <gemmi/model.hpp>
#include <set>
#include <string>
#include <vector>

#include "input/read_structure.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/structure/structure_atoms.hpp"

namespace eses::detail {

/// Returns the atoms of the chosen assembly, and adds the names of the copies of chains to `names`.
/// The selected atoms are those of the only model. Moves the atoms that the assembly does not
/// contain from the counts of atoms that were read to StructureReport::dropped_assembly. Throws
/// Error if there is no such assembly, if its description is incomplete, or if it has too many
/// operators or atoms.
std::vector<StructureAtom> build_assembly(const gemmi::Structure& structure,
                                          const StructureText& text, std::set<std::string>& names,
                                          StructureReport& report);

/// Returns the assemblies that have several operators, or not all of the selected atoms, which are
/// those of the only model. Assemblies without selected atoms are left out.
std::vector<OtherAssembly> find_other_assemblies(const gemmi::Structure& structure);

}  // namespace eses::detail
