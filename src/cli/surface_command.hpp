#pragma once
/// What `eses-blocks FILE` does.

#include "cli/options.hpp"
#include "distributed/processes.hpp"

namespace eses::detail::cli {

/// Computes the surface and writes the files; to be called by all processes. Returns the exit code.
int compute_surface(const Options& options, const Processes& processes);

}  // namespace eses::detail::cli
