#pragma once
/// Reports of the atoms that were read from a PDB or mmCIF file or left out.

#include <string>

#include "cli/json.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {

/// Returns the lines of the text report, which begin with `read:`, `left out:` and `radii:`.
std::string structure_text(const StructureReport& report);

/// Returns the report as one JSON object.
json::Value structure_json(const StructureReport& report);

}  // namespace eses::detail::cli
