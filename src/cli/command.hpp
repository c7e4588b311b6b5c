#pragma once
/// The program `eses-blocks` from its command line to its exit code.

#include "task/task.hpp"

namespace eses::detail::cli {

/// Exit codes of `run_command`.
inline constexpr int exit_done = 0;
inline constexpr int exit_failure = 1;  ///< input, output or resources, or a fault in the result
inline constexpr int exit_usage = 2;    ///< the command line itself

/// Exit codes of `eses-blocks diff`, those of diff(1), besides 0 for directories that are the same.
inline constexpr int exit_different = 1;
inline constexpr int exit_trouble = 2;  ///< input, output, resources or the command line

/// That of a run which came to its end.
int exit_code(const Summary& summary);

/// Runs the program; throws nothing. Results go to standard output; errors, warnings and the
/// progress bar to standard error.
int run_command(int argc, char** argv);

}  // namespace eses::detail::cli
