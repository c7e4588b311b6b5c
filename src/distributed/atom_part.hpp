#pragma once
/// Distributed reading of an atom file.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "distributed/file_diagnostics.hpp"
#include "distributed/processes.hpp"
#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"
#include "output/mesh_groups.hpp"

namespace eses::detail {

/// The part of a file that a process has read, without labels and charges. Only the first process
/// has the report of a PDB or mmCIF file.
struct AtomPart : AtomFile {
  std::uint64_t first = 0;                 ///< index of the first atom in the file, 0-based
  std::uint64_t total = 0;                 ///< number of atoms in the file
  std::vector<mesh::GroupNumbers> groups;  ///< by atom, filled by number_groups
  /// Residues if labels were requested and the file has them; also the names of atoms in a PDB or
  /// mmCIF file, which the first process alone reads, and in a PQR file if they were requested.
  AtomNames names;
  /// The diagnostics of reading the whole file; the same in all processes.
  FileDiagnostics file_diagnostics;

  /// The indices of the atoms in the file, 0-based.
  IndexRange range() const { return {first, first + atoms.size()}; }
};

/// Reads a file. All processes must call it. Several processes read a plain file in parts of equal
/// size. The first process alone reads a compressed file, a PDB or mmCIF file, a model of a PQR
/// file, and a file that is not regular, such as standard input. Labels are kept as residues if
/// `options` requests them, and also by atom if `with_names` is true. The memory limit of `options`
/// applies to each process.
///
/// Throws SharedError if read_atoms would throw Error, for the first error in the file.
AtomPart read_part(const std::filesystem::path& path, ReadOptions options, bool with_names,
                   const Processes& processes);

}  // namespace eses::detail
