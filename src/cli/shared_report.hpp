#pragma once
/// Parts of the reports of several commands.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "cli/diagnostics.hpp"
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

/// Returns the first lines of a report on a file: its name, its atoms, and what was read or left
/// out.
std::string heading_text(const std::filesystem::path& path, std::size_t atoms, double probe_radius,
                         const std::optional<StructureReport>& structure,
                         std::span<const DiagnosticText> diagnostics);

/// Returns the names of the members of a JSON object as the columns of a CSV table (RFC 4180, but
/// with LF as line end). Those of a vector end with `_x`, `_y` and `_z`.
std::string csv_heading(const Json& record);

/// Returns the members as the fields of a row. Numbers that are not whole have six decimals. A list
/// is one field, with blanks between its numbers, or semicolons between its texts.
std::string csv_row(const Json& record);

/// Returns the name of a chain or part for reports. Chains may have no name.
std::string shown_name(std::string_view name);

/// Returns the number of atoms that were left out.
std::uint64_t left_out_atoms(const StructureReport& report);

/// Returns the line about filled cavities.
std::string filling_text(std::span<const FilledCavity> filled);

}  // namespace eses::detail::cli
