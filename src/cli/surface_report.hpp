#pragma once
/// Reports of a run: the plan before the computation, and the results after it.

#include <cstdint>
#include <string>
#include <vector>

#include "cli/shared_report.hpp"
#include "cli/surface_options.hpp"
#include "output/output_files.hpp"
#include "run/engine.hpp"
#include "run/planned_run.hpp"

namespace eses::detail::cli {

/// The data of a run for its reports.
struct Report {
  Options options;
  PlannedRun run;
  std::vector<DiagnosticText> diagnostics = {};  ///< of atoms, and those of add_run_diagnostics
  std::vector<DiskSpace> disk = {};
  RunResult result = {};                ///< empty before the run
  std::uint64_t peak_memory_bytes = 0;  ///< maximum over all processes
  int process_count = 1;
  /// Figures by rank, only of a distributed or resumable run; empty before the run.
  std::vector<ProcessFigures> processes = {};
};

/// Returns the first faults that the verification found, and a line with their number. Empty if
/// there are no faults.
std::vector<std::string> fault_lines(const Summary& summary);

/// Returns the lines `surface area: ...` and `surface volume: ...`. Scripts search for `area:` and
/// `volume:`, so no other line of the report contains these texts.
std::string result_text(const Summary& summary);

/// Returns the plan of the run as text.
std::string plan_text(const Report& report);

/// Returns all results as text, except area and volume.
std::string summary_text(const Report& report);

/// Returns the line of a part that is complete. `is_locked` tells whether the last part writes the
/// files.
std::string part_text(const Report& report, bool is_locked);

/// Returns plan and results as one JSON object; for a dry run and for a part, without the surface.
std::string json_text(const Report& report);

/// Adds the diagnostics of the plan and the disk: lengths that may be swapped, far atoms, a grid
/// that cuts the surface (see Plan::cut_depth), and insufficient disk space.
void add_run_diagnostics(Report& report);

}  // namespace eses::detail::cli
