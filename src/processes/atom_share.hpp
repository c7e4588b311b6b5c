#pragma once
/// How processes read the atoms of one file, each a part.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "eses/read_atoms.hpp"
#include "processes/processes.hpp"

namespace eses {

/// Consecutive atoms of a file.
struct AtomShare {
  std::vector<Atom> atoms;
  std::vector<std::uint64_t> lines;  ///< of each, 1-based
  std::uint64_t first = 0;           ///< index of the first in the file, 0-based
  std::uint64_t total = 0;           ///< atoms of the file
  /// The residues of these atoms, if they are asked for and told: a label for each run of atoms
  /// that have the same one, without the atom's name.
  std::vector<AtomLabel> residues;
  std::vector<std::uint64_t> residue_atoms;  ///< of each
  std::vector<std::uint32_t> residue_of;     ///< by atom; see share_residue_names
};

/// To be called by all processes. A plain file is read in parts of as many bytes each; a compressed
/// one, or one that is no regular file, such as standard input, by the first process alone. Throws
/// SharedError where read_numbered_atoms would throw Error; of several errors in the file the first
/// is told.
AtomShare read_share(const std::filesystem::path& path, AtomFormat format, bool with_residues,
                     const Processes& processes);

}  // namespace eses
