#pragma once
/// The command `eses-blocks FILE`.

#include "cli/options.hpp"
#include "distributed/processes.hpp"

namespace eses::detail::cli {

/// Reads the input, computes the surface and writes the files. Calls plan_run
/// (run/run_plan.hpp) and execute (run/engine.hpp). All processes must call it. Returns the
/// exit code.
int compute_surface(const Options& options, const Processes& processes);

}  // namespace eses::detail::cli
