#pragma once
/// Biological assemblies: copies of chains by operators.

#include <cstdint>
#include <functional>
#include <gemmi/model.hpp>
#include <string>
#include <vector>

#include "input/checker.hpp"
#include "input/parse_structure.hpp"

namespace eses::detail {

/// Adds the atoms of the assembly `id` to `result`. The selected atoms are the atoms of `model`, a
/// model of `structure`. Moves the atoms that the assembly does not contain from the counts of
/// atoms that were read to StructureReport::dropped_assembly. Calls `checker` for each operator,
/// and `require_memory` with the number of bytes before each large allocation. Throws Error if
/// there is no such assembly, if its description is incomplete, or if it has too many operators or
/// atoms.
void build_assembly(const gemmi::Structure& structure, const std::string& id,
                    const gemmi::Model& model, const StructureText& text, Checker& checker,
                    const std::function<void(std::uint64_t bytes)>& require_memory,
                    SelectedStructure& result);

/// Returns the assemblies of `structure` that have several operators, or not all of the selected
/// atoms, which are the atoms of `model`. Assemblies without selected atoms are left out.
std::vector<OtherAssembly> find_other_assemblies(const gemmi::Structure& structure,
                                                 const gemmi::Model& model,
                                                 const StructureText& text);

}  // namespace eses::detail
