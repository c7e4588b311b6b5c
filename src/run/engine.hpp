#pragma once
/// The engine: one run, from the plan of planned_run.hpp to its files and its summary.
///
/// A run is a sweep over ranges of planes that delivers rows, crossings and triangles in canonical
/// order. A single process has one range and writes its pieces directly to the output files.
/// Otherwise the pieces of each range go into a chunk of a checkpoint, and the first process passes
/// the pieces of all chunks to the output files at the end. There are several ranges if the run can
/// be resumed, or if there are several MPI ranks, each with its slab of planes. The bytes of the
/// files do not depend on the ranges.

#include <cstdint>
#include <optional>
#include <vector>

#include "eses/measure.hpp"
#include "geometry/plane_range.hpp"
#include "run/planned_run.hpp"
#include "system/processes.hpp"

namespace eses::detail {

/// The work of one process.
struct ProcessFigures {
  PlaneRange planes;
  std::uint64_t atoms = 0;  ///< number of atoms that influence these planes
  double cpu_seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
};

/// The result of a run.
struct RunResult {
  /// Complete only in the first process. All processes have its verification.
  Summary summary;
  /// The whole surface, also if only a part of it was computed; if Parameters::exact is set.
  std::optional<Measures> exact;
};

/// Returns the figures of all processes, by rank. All processes must call it.
std::vector<ProcessFigures> gather_figures(const PlannedRun& run, const Processes& processes);

/// Returns whether the verification has found faults. Then no file was written.
bool has_faults(const Summary& summary);

/// Computes the surface and writes the files of a run. All processes must call it. A SharedError
/// is thrown in all processes. Any other exception is thrown only in the process that failed, whose
/// caller must then abort the other processes.
RunResult execute(PlannedRun& run, const Callbacks& callbacks, const Processes& processes);

}  // namespace eses::detail
