#pragma once
/// The checkpoint of a run: whether it belongs to the run, and which planes it has.

#include <span>

#include "distributed/processes.hpp"
#include "eses/atoms.hpp"
#include "run/planned_run.hpp"

namespace eses::detail {

/// Opens the checkpoint of a run that needs one: of several processes, or whose chunks are kept.
/// Finds its complete chunks. `atoms` and `groups` are those of the file. All processes must call
/// it. Throws SharedError if they have read different atoms, and NotJoined or an error if the
/// chunks cannot be used.
void open_checkpoint(std::span<const Atom> atoms, std::span<const mesh::GroupNumbers> groups,
                     const Processes& processes, PlannedRun& run);

}  // namespace eses::detail
