#pragma once
/// Diagnostics of the atoms of a file.

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/diagnostics.hpp"
#include "input/file_index.hpp"

namespace eses::detail {

/// Diagnostics with the lines of their examples in the file.
struct FileDiagnostics {
  std::vector<Diagnostic> diagnostics;       ///< in the order of `DiagnosticKind`
  std::map<FileIndex, std::uint64_t> lines;  ///< line of each atom that is an example, 1-based
  /// Labels of these atoms, if the file is a PDB or mmCIF file.
  std::map<FileIndex, AtomLabel> labels;

  /// Adds diagnostics of other kinds. `lines_of_atoms` has the line of each atom of the file.
  void add(std::span<const Diagnostic> others, std::span<const std::uint64_t> lines_of_atoms) {
    diagnostics.insert(diagnostics.end(), others.begin(), others.end());
    std::sort(diagnostics.begin(), diagnostics.end(),
              [](const Diagnostic& a, const Diagnostic& b) { return a.kind < b.kind; });
    for (const Diagnostic& diagnostic : others)
      for (const auto& [atom, other, of_record] : diagnostic.examples)
        for (const AtomIndex index : {atom, other})
          if (of_record == 0 && index < lines_of_atoms.size())
            lines[FileIndex{index}] = lines_of_atoms[index];
  }
};

}  // namespace eses::detail
