#pragma once
/// The command line of `eses-blocks interface` as plain data.

#include <optional>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/table_options.hpp"

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

/// Parses the arguments of the command. Throws UsageError and Notice.
InterfaceOptions parse_interface_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
