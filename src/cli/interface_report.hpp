#pragma once
/// The texts of `eses-blocks interface`.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cli/diagnostics.hpp"
#include "cli/interface_options.hpp"
#include "eses/interface.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {

/// An interface with the names of its sides.
struct NamedInterface {
  std::string first, second;
  Interface areas;
  std::vector<std::uint32_t> parts;  ///< part of each atom of the interface, as in `areas`
};

/// The interfaces of a file.
struct InterfaceFile {
  std::filesystem::path path;
  int model = 0;  ///< number of the model; 0 unless each model is measured
  AtomFile file;  ///< with labels
  std::vector<DiagnosticText> diagnostics;
  std::vector<bool> are_polar;             ///< by atom
  std::vector<NamedInterface> interfaces;  ///< without those below InterfaceOptions::min_area
};

/// Returns why the tables of interfaces or residues have no rows; empty if they have some.
std::string empty_table_reason(const InterfaceOptions& options, const InterfaceFile& file);

/// Returns the names of the columns of rows (see InterfaceRows) as CSV.
std::string heading_of_rows(unsigned rows);

/// Returns rows of a file as CSV. Each begins with `start` and ends with `end`.
std::string rows_text(const InterfaceOptions& options, unsigned rows, const InterfaceFile& file,
                      std::string_view start = "", std::string_view end = "");

/// Returns a whole table of a file: CSV with its heading, or the atoms with the SAS areas that they
/// lose in all interfaces as B-factors. Throws Error if a name is too wide for its columns.
std::string interface_table(const InterfaceOptions& options, const Table& table,
                            const InterfaceFile& file);

/// Returns the report about a file, or with --json its JSON object.
std::string interface_text(const InterfaceOptions& options, const InterfaceFile& file);

}  // namespace eses::detail::cli
