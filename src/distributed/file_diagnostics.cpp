#include "distributed/file_diagnostics.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace eses::detail {
namespace {

// An example of a diagnostic, as processes exchange it.
struct FileExample {
  DiagnosticKind kind{};
  FileAtom atom, other;
};

}  // namespace

void FileDiagnostics::add(const FileDiagnostics& other) {
  diagnostics.insert(diagnostics.end(), other.diagnostics.begin(), other.diagnostics.end());
  std::sort(diagnostics.begin(), diagnostics.end(),
            [](const Diagnostic& a, const Diagnostic& b) { return a.kind < b.kind; });
  lines.insert(other.lines.begin(), other.lines.end());
}

FileDiagnostics gather_diagnostics(std::span<const Diagnostic> diagnostics,
                                   const std::function<FileAtom(AtomIndex)>& in_file,
                                   const Processes& processes) {
  std::vector<FileExample> examples;
  std::array<std::uint64_t, diagnostic_kinds> counts{};
  for (const Diagnostic& diagnostic : diagnostics) {
    counts[static_cast<std::size_t>(diagnostic.kind)] = diagnostic.count;
    for (const auto& [atom, other] : diagnostic.examples)
      examples.push_back({diagnostic.kind, in_file(atom), in_file(other)});
  }
  processes.add(counts);
  examples = processes.gather<FileExample>(examples);
  std::sort(examples.begin(), examples.end(), [](const FileExample& a, const FileExample& b) {
    return std::pair(a.kind, a.atom.index) < std::pair(b.kind, b.atom.index);
  });
  FileDiagnostics all;
  for (std::size_t kind = 0; kind < counts.size(); ++kind)
    if (counts[kind] > 0)
      all.diagnostics.push_back({static_cast<DiagnosticKind>(kind), counts[kind], {}});
  for (Diagnostic& diagnostic : all.diagnostics) {
    for (const auto& [kind, atom, other] : examples) {
      if (kind != diagnostic.kind) continue;
      if (diagnostic.examples.size() == Diagnostic::max_examples) break;
      diagnostic.examples.push_back({as_number(atom.index), as_number(other.index)});
      for (const auto& [index, line] : {atom, other}) all.lines[as_number(index)] = line;
    }
  }
  return all;
}

}  // namespace eses::detail
