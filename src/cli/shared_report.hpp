#pragma once
/// Parts of the reports of several commands.

#include <cstdint>
#include <exception>
#include <filesystem>
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

/// Returns the message of an exception that ends the work on a file, with the name of the file.
std::string message_with_file(const std::exception& error, const std::filesystem::path& path);

/// Returns the JSON object, in a line, of a file that cannot be measured. `model` is the number of
/// its model; 0 if it is not chosen.
std::string failure_json(const std::filesystem::path& path, const std::string& error,
                         int model = 0);

/// Returns the line about filled cavities.
std::string filling_text(std::span<const FilledCavity> filled);

}  // namespace eses::detail::cli
