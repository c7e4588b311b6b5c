#pragma once
/// The commands `eses-blocks pdb_to_xyzr` and `eses-blocks pdb_to_xyzrn`, which make input files of
/// MSMS as its scripts of these names do.

namespace eses::detail::cli {

/// Prints the spheres of a PDB or mmCIF file. `argv[0]` is the name of the command; with a final
/// `n` the spheres have names. Returns the exit code. Throws UsageError.
int print_spheres(int argc, const char* const* argv);

}  // namespace eses::detail::cli
