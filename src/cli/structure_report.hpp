#pragma once
/// Reports of what was read of a PDB or mmCIF file, and what was left out.

#include <string>

#include "cli/json.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {

/// Lines for the text report, which begin with `read:`, `left out:` and `radii:`.
std::string structure_text(const StructureReport& report);

/// One JSON object.
json::Value structure_json(const StructureReport& report);

}  // namespace eses::detail::cli
