#pragma once
/// What `eses-blocks FILE` does.

#include "cli/options.hpp"
#include "distributed/processes.hpp"

namespace eses::cli {

/// Computes the surface in this process. Returns the exit code.
int compute_alone(const Options& options);

/// Computes it together with other processes, or so that it can be resumed: see joint_run.hpp.
int compute_jointly(const Options& options, const Processes& processes);

/// Throws Error if what is to be written would take the input's place.
void refuse_to_lose_input(const Options& options);
/// Throws Error if areas by residue are asked for of a file that tells no residues.
void refuse_residues_of_xyzr(const Options& options);

}  // namespace eses::cli
