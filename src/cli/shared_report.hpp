#pragma once
/// Parts of the reports of several commands.

#include <span>
#include <string>

#include "cli/json.hpp"
#include "eses/cavities.hpp"
#include "eses/read_atoms.hpp"

namespace eses {

/// Converts the report of reading a PDB or mmCIF file.
void to_json(detail::Json& json, const StructureReport& report);

inline void to_json(detail::Json& json, const FilledCavity& cavity) {
  json = {{"id", cavity.id}, {"void_volume", cavity.void_volume}};
}

}  // namespace eses

namespace eses::detail::cli {

/// Returns the lines about the atoms of a PDB or mmCIF file that were read or left out. They begin
/// with `read:`, `left out:` and `radii:`.
std::string structure_text(const StructureReport& report);

/// Returns the line about filled cavities.
std::string filling_text(std::span<const FilledCavity> filled);

}  // namespace eses::detail::cli
