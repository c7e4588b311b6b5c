#pragma once
/// The command line of `eses-blocks msms` as plain data. It is that of MSMS:
/// https://ccsb.scripps.edu/msms/documentation/

#include <cstdint>
#include <filesystem>
#include <vector>

#include "cli/command.hpp"

namespace eses::detail::cli {

struct MsmsOptions {
  std::filesystem::path input;      ///< `-` is standard input
  std::filesystem::path surface;    ///< path of the triangles without suffix; empty for none
  std::filesystem::path areas;      ///< path of the areas of the atoms; empty for none
  double probe_radius = 1.5;        ///< angstrom
  double density = 1;               ///< vertices in a square angstrom
  double high_density = 3;          ///< without effect
  bool has_triangles = true;        ///< whether triangles are written, and their areas printed
  bool has_areas = true;            ///< whether analytical areas are printed and written
  bool has_header = true;           ///< whether the files of the triangles have a header
  bool has_hydrogens = true;        ///< whether spheres with the radius of hydrogen are used
  bool allow_far_atoms = false;     ///< see Parameters::allow_far_atoms
  bool has_all_components = false;  ///< whether all components are written, or only the first one
  /// Atoms that the chosen component touches, from 0 in the order of the file; empty if the
  /// component is not chosen by atoms.
  std::vector<std::uint64_t> cavity_atoms;
};

/// Parses the arguments of the command. Throws UsageError and Notice.
MsmsOptions parse_msms_arguments(const Arguments& arguments);

}  // namespace eses::detail::cli
