#pragma once
/// How processes read the atoms of one file, each a part.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "distributed/processes.hpp"
#include "eses/read_atoms.hpp"

namespace eses {

/// Consecutive atoms of a file, 0-based.
struct AtomRange {
  std::uint64_t begin = 0, end = 0;
};

/// The residues of consecutive atoms: runs of those that have the same label.
struct ResidueRuns {
  std::vector<AtomLabel> labels;     ///< without the atom's name
  std::vector<std::uint64_t> atoms;  ///< of each run
};

/// What a mesh calls an atom's chain and residue.
struct GroupNumbers {
  std::uint32_t chain = 0, residue = 0;
};

/// What a process reads of a file.
struct AtomShare {
  std::vector<Atom> atoms;
  std::vector<std::uint64_t> lines;  ///< of each, 1-based
  std::uint64_t first = 0;           ///< index of the first in the file, 0-based
  std::uint64_t total = 0;           ///< atoms of the file
  ResidueRuns residues;              ///< if they are asked for and the file tells them
  std::vector<GroupNumbers> groups;  ///< by atom: see number_groups

  AtomRange range() const { return {first, first + atoms.size()}; }
};

/// To be called by all processes. A plain file is read in parts of as many bytes each; a compressed
/// one, or one that is no regular file, such as standard input, by the first process alone. Throws
/// SharedError where read_numbered_atoms would throw Error; of several errors in the file the first
/// is told. Residues are read if `options` asks for labels; its limit on memory is that of each
/// process.
AtomShare read_share(const std::filesystem::path& path, ReadOptions options,
                     const Processes& processes);

}  // namespace eses
