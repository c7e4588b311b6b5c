#pragma once
/// The engine: one run, from its plan to its files and its summary.
///
/// A run is a sweep over ranges of planes that delivers rows, crossings and triangles in canonical
/// order. A process that is alone has one range, whose texts go directly to their places in the
/// files. With several processes each has a slab, and in a run that can be resumed a slab is cut
/// into ranges; their texts go into chunks, which are merged into the files when all are there. The
/// files do not depend on who did what.

#include <cstdint>
#include <string>
#include <vector>

#include "compute/run_plan.hpp"
#include "distributed/processes.hpp"
#include "grid/plane_range.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// The work of one process.
struct ProcessFigures {
  PlaneRange planes;
  std::uint64_t atoms = 0;  ///< that influence these planes
  double cpu_seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
};

struct RunResult {
  /// The same in all processes, but for `atom_areas`, which only a process that is alone has.
  Summary summary;
  std::vector<ProcessFigures> processes;  ///< by rank
};

/// Whether the run was verified and found wrong. Then it has written no file.
bool has_faults(const Summary& summary);

/// What a run creates, and must not leave behind if it fails.
struct RunPaths {
  std::vector<std::string> temporaries, locks;
};

/// The paths of the first process; to be called by all processes.
RunPaths paths_of(const RunTask& task, const Processes& processes);

/// Computes the surface and writes the files as eses::detail::run does; to be called by all
/// processes. If it throws anything but SharedError, the other processes do not know, and have to
/// be aborted.
RunResult execute(const RunTask& task, const RunPlan& plan, const RunPaths& paths,
                  const Callbacks& callbacks, const Processes& processes);

}  // namespace eses::detail
