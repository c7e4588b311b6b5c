#pragma once
/// The command line of `eses-blocks interface` as plain data.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/input_models.hpp"
#include "eses/surface.hpp"

namespace eses::detail::cli {

/// The outputs of `eses-blocks interface`: the report, tables as CSV, and the atoms with buried
/// areas as B-factors.
enum class InterfaceTable { report, interfaces, residues, atoms, pdb, cif };

/// A table of `--write` or `--table`. The table of NAME.pdb is written to NAME + `ending`.
struct NamedInterfaceTable {
  std::string_view name, ending;
  InterfaceTable table;
};
inline constexpr std::array interface_tables{
    NamedInterfaceTable{"interfaces", ".interfaces.csv", InterfaceTable::interfaces},
    NamedInterfaceTable{"residues", ".interface.residues.csv", InterfaceTable::residues},
    NamedInterfaceTable{"atoms", ".interface.atoms.csv", InterfaceTable::atoms},
    NamedInterfaceTable{"pdb", ".interface.areas.pdb", InterfaceTable::pdb},
    NamedInterfaceTable{"cif", ".interface.areas.cif", InterfaceTable::cif},
};

struct InterfaceOptions : ModelOptions {
  std::filesystem::path list;  ///< file of --files-from; empty if it is not given
  PartChoice groups{.by_chain = true};
  std::optional<PartSelector> ligand;  ///< residues that are each compared with all other atoms
  double probe_radius = SurfaceOptions().probe_radius;
  double min_area = 0;           ///< least SAS interface area of an interface, square angstrom
  double min_residue_area = 15;  ///< least SAS area that an interface residue loses
  InterfaceTable table = InterfaceTable::report;
  std::vector<const NamedInterfaceTable*> written_tables;  ///< in the order of `interface_tables`
  std::filesystem::path output_directory = ".";            ///< of the tables
  std::filesystem::path csv;  ///< file of --csv; empty if there is none
  bool prints_csv = false;    ///< whether the table of --csv is printed in place of the report
  bool resume = false;
  std::optional<std::string> resumed;  ///< see resume_identity
  int threads = 0;                     ///< 0 means all available processors
  bool json = false;
  bool quiet = false;
  bool strict = false;  ///< whether warnings are errors
};

/// Parses the arguments of the command. Throws UsageError and Notice.
InterfaceOptions parse_interface_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
