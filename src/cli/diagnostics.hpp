#pragma once
/// Text of input diagnostics, with line numbers.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/json.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "run/far_atoms.hpp"
#include "run/input_atoms.hpp"

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

/// Returns the warning about a few atoms far from all others, such as placeholders, which would
/// make the usual grid large and empty; nothing if there are none. `lines` has the line of each
/// atom of the file.
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

}  // namespace eses::detail::cli
