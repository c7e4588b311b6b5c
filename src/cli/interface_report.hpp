#pragma once
/// The options and results of `eses-blocks interface`, and their texts.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/complex_parts.hpp"
#include "cli/shared_report.hpp"
#include "cli/table_options.hpp"
#include "eses/interface.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {

/// The rows of a table of CSV; see Table::traits. The other tables are the atoms of the file with
/// buried areas as B-factors.
enum InterfaceRows : unsigned {
  no_rows = 0,
  rows_of_interfaces = 1,
  rows_of_residues = 2,
  rows_of_atoms = 4,
};

struct InterfaceOptions : TableOptions {
  PartChoice groups{.by_chain = true};
  std::optional<PartSelector> ligand;  ///< residues that are each compared with all other atoms
  double min_area = 0;           ///< least SAS interface area of an interface, square angstrom
  double min_residue_area = 15;  ///< least SAS area that an interface residue loses
};

/// An interface with the names of its sides.
struct NamedInterface {
  std::string first, second;
  Interface areas;
  std::vector<std::uint32_t> parts;  ///< part of each atom of the interface, as in `areas`
};

/// The interfaces of a file.
struct InterfaceFile {
  ReportedInput input;
  AtomFile file;                           ///< with labels
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

/// Appends a whole table of a file: CSV with its heading, or the atoms with the SAS areas that they
/// lose in all interfaces as B-factors. Throws Error if a name is too wide for its columns.
void append_interface_table(const InterfaceOptions& options, const Table& table,
                            const InterfaceFile& file, BufferedText& text);

/// Returns the report about a file.
std::string interface_text(const InterfaceOptions& options, const InterfaceFile& file);

/// Returns the results as one JSON object in a line.
std::string interface_json(const InterfaceOptions& options, const InterfaceFile& file);

}  // namespace eses::detail::cli
