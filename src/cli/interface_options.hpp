#pragma once
/// The command line of `eses-blocks interface` as plain data.

#include <filesystem>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"

namespace eses::detail::cli {

/// The outputs of `eses-blocks interface`.
enum class InterfaceTable { report, interfaces, residues, atoms };

struct InterfaceOptions {
  std::vector<std::filesystem::path> inputs;  ///< without folders; `-` is standard input
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< for PDB and mmCIF files
  PartChoice groups{.by_chain = true};
  std::string ligand;  ///< name of the residues to compare with all other atoms; empty for groups
  double probe_radius = SurfaceOptions().probe_radius;
  double min_area = 0;           ///< least SAS interface area of an interface, square angstrom
  double min_residue_area = 15;  ///< least SAS area that an interface residue loses
  InterfaceTable table = InterfaceTable::report;
  int threads = 0;  ///< 0 means all available processors
  bool json = false;
  bool quiet = false;
  bool strict = false;  ///< whether warnings are errors
};

/// Parses the arguments of the command. Throws UsageError and Notice.
InterfaceOptions parse_interface_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
