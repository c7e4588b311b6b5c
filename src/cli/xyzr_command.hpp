#pragma once
/// The commands `eses-blocks pdb_to_xyzr` and `eses-blocks pdb_to_xyzrn`, which make input files of
/// MSMS as its scripts of these names do.

#include <string>
#include <vector>

namespace eses::detail::cli {

/// Prints the spheres of a PDB or mmCIF file. Throws UsageError and Notice.
void print_spheres(bool has_names, std::vector<std::string> arguments);

}  // namespace eses::detail::cli
