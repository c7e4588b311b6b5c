#pragma once
/// What the user is told: the plan before the work, the results after it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/diagnostics.hpp"
#include "cli/options.hpp"
#include "compute/engine.hpp"
#include "output/output_files.hpp"
#include "task/task.hpp"

namespace eses::detail::cli {

/// A run as far as the reports are concerned.
struct Report {
  Options options;
  std::size_t atoms = 0;
  std::vector<DiagnosticText> diagnostics;
  std::optional<StructureReport> structure;  ///< of a PDB or mmCIF file
  Plan plan;
  DiskSpace disk;
  Summary summary;                      ///< empty before the run
  std::uint64_t peak_memory_bytes = 0;  ///< of the process, or the one that held most
  int process_count = 1;
  /// By rank, of a run with several processes or one that can be resumed; empty before the run.
  std::vector<ProcessFigures> processes;
};

/// The first faults that the verification found, and how many there are; empty if there are none.
std::vector<std::string> fault_lines(const Summary& summary);

/// `area` and `volume`, each alone on its line, for callers that search for `area:` and `volume:`.
/// No line of the other texts holds either.
std::string result_text(const Summary& summary);

/// What is going to be done.
std::string plan_text(const Report& report);

/// What was done, besides area and volume.
std::string summary_text(const Report& report);

/// Plan, result and summary as one JSON object; of a dry run, the plan.
std::string json_text(const Report& report);

/// What to warn about, a line each: what is odd in the input, a grid that cuts the surface (see
/// eses::detail::cut_depth), a disk that is expected to fill up.
std::vector<std::string> warnings(const Report& report);

/// `text` as a single line: bytes that would move a terminal's cursor become `?`.
std::string one_line(std::string_view text);

/// `1 edge`, `2 edges`
std::string counted(std::int64_t count, std::string_view noun);

}  // namespace eses::detail::cli
