#pragma once
/// Parts of the reports of several commands: diagnostics of the input, what was read, and rows of
/// CSV.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/json.hpp"
#include "eses/cavities.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "run/far_atoms.hpp"
#include "run/input_atoms.hpp"

namespace eses {

/// Converts the report of reading a PDB or mmCIF file.
void to_json(detail::Json& json, const StructureReport& report);

inline void to_json(detail::Json& json, const FilledCavity& cavity) {
  json = {{"id", cavity.id}, {"void_volume", cavity.void_volume}};
}

}  // namespace eses

namespace eses::detail::cli {

/// One kind of diagnostic.
struct DiagnosticText {
  struct Example {
    std::optional<AtomIndex> atom = {};  ///< null for a line that is no atom
    std::uint64_t line = 0;
    std::optional<std::string> label = {};  ///< such as A/LYS 33/CE
    // The other atom of a pair, if the diagnostic has one.
    std::optional<AtomIndex> other_atom = {};
    std::optional<std::uint64_t> other_line = {};
    std::optional<std::string> other_label = {};
  };
  std::string_view name;    ///< identifier in the JSON report
  bool is_usual = false;    ///< whether it is a note rather than a warning
  std::uint64_t count = 0;  ///< number of atoms; 0 if it is not about atoms
  std::string short_text;   ///< count and description, of a note
  std::string message;      ///< one line: file, count, description and first few line numbers
  std::vector<Example> examples;
  bool is_printed = false;  ///< whether the user has been told already
};

/// Returns the JSON report of a diagnostic.
void to_json(Json& json, const DiagnosticText& diagnostic);

/// Returns a warning of the program that is not about atoms.
DiagnosticText program_warning(std::string_view name, std::string message);

/// Returns the warning about atoms far from the others. The examples are indices in the file.
/// `labels` has their labels, if the file is a PDB or mmCIF file.
DiagnosticText describe(const FarAtomsWarning& far, const std::map<FileIndex, AtomLabel>& labels);

/// Returns the warning about atoms of a surface far from the others. The examples are indices of
/// the surface, whose atoms have the indices `in_file` in the file.
DiagnosticText describe(FarAtomsWarning far, const Surface& surface, const FileIndices& in_file);

/// Returns the warning about the atoms of find_stray_atoms; nothing if there are none. `lines` has
/// the line of each atom of the file.
std::optional<DiagnosticText> far_atoms_of(const Surface& surface, const FileIndices& in_file,
                                           std::span<const std::uint64_t> lines,
                                           const std::filesystem::path& input);

/// Returns the texts of the diagnostics of a file.
std::vector<DiagnosticText> describe(const FileDiagnostics& diagnostics,
                                     const std::filesystem::path& input);

/// Returns the texts of the diagnostics of the atoms that were read, and of their surface. The
/// labels are those of the surface.
std::vector<DiagnosticText> describe(const AtomFile& atoms, const Surface& surface,
                                     const std::filesystem::path& input);

/// Returns the messages of the warnings that the user has not been told yet, or nothing if
/// `is_quiet`. With `is_strict`, throws StrictError if there are some.
std::vector<std::string> warnings_to_print(std::span<const DiagnosticText> diagnostics,
                                           bool is_strict, bool is_quiet);

/// An input file and what was found when it was read.
struct ReportedInput {
  std::filesystem::path path;
  std::optional<int> model = {};  ///< number of the model, if each model is measured
  std::vector<DiagnosticText> diagnostics = {};
  std::optional<StructureReport> structure = {};  ///< only for PDB and mmCIF files

  /// Both names of the chains, if the labels have those of label_asym_id.
  std::span<const ChainName> label_chains() const;
};

/// Returns the lines about the atoms of a PDB or mmCIF file that were read or left out. They begin
/// with `read:`, `left out:` and `radii:`.
std::string structure_text(const StructureReport& report);

/// Returns the first lines of a report on a file: its name, its atoms, and what was read or left
/// out.
std::string heading_text(const ReportedInput& input, std::size_t atoms, double probe_radius);

/// Returns the first members of the JSON object of a file.
Json first_members(const ReportedInput& input, std::size_t atoms, double probe_radius);

/// Adds the last members: what was read or left out, and the diagnostics.
void add_last_members(Json& object, const ReportedInput& input);

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
