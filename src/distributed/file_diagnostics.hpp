#pragma once
/// Diagnostics of a whole file, whose atoms several processes inspect.

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "distributed/processes.hpp"
#include "eses/atoms.hpp"
#include "eses/diagnostics.hpp"
#include "input/file_index.hpp"

namespace eses::detail {

/// Diagnostics with the indices of atoms in the file.
struct FileDiagnostics {
  std::vector<Diagnostic> diagnostics;       ///< in the order of `DiagnosticKind`
  std::map<AtomIndex, std::uint64_t> lines;  ///< line of each atom that is an example, 1-based
  /// Labels of these atoms; only in the first process, and only of a PDB or mmCIF file.
  std::map<AtomIndex, AtomLabel> labels;

  /// Adds diagnostics of other kinds, without their labels.
  void add(const FileDiagnostics& other);
};

/// An atom of a file.
struct FileAtom {
  FileIndex index{};
  std::uint64_t line = 0;  ///< 1-based
};

/// Combines the diagnostics of all processes, without labels. All processes must call it.
/// `in_file` converts the indices of the atoms in `diagnostics`, which are the diagnostics that
/// this process has found. The result has indices in the file.
FileDiagnostics gather_diagnostics(std::span<const Diagnostic> diagnostics,
                                   const std::function<FileAtom(AtomIndex)>& in_file,
                                   const Processes& processes);

}  // namespace eses::detail
