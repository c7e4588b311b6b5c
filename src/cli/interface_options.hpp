#pragma once
/// The command line of `eses-blocks interface` as plain data.

#include <array>
#include <optional>
#include <string_view>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/table_options.hpp"

namespace eses::detail::cli {

/// The tables of `eses-blocks interface`: CSV, and the atoms with buried areas as B-factors.
enum class InterfaceTable { interfaces, residues, atoms, pdb, cif };

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

struct InterfaceOptions : OptionsOfTables<NamedInterfaceTable> {
  PartChoice groups{.by_chain = true};
  std::optional<PartSelector> ligand;  ///< residues that are each compared with all other atoms
  double min_area = 0;           ///< least SAS interface area of an interface, square angstrom
  double min_residue_area = 15;  ///< least SAS area that an interface residue loses
};

/// Parses the arguments of the command. Throws UsageError and Notice.
InterfaceOptions parse_interface_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
