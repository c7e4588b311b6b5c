#pragma once
/// The program `eses-blocks` from its command line to its exit code.

namespace eses::detail::cli {

/// Exit codes of `run_command`.
inline constexpr int exit_done = 0;
inline constexpr int exit_failure = 1;  ///< input, output or resource error, or faults found
inline constexpr int exit_usage = 2;    ///< error in the command line

/// Exit codes of `eses-blocks diff`, which are the codes of diff(1); 0 means that there are no
/// differences.
inline constexpr int exit_different = 1;
inline constexpr int exit_trouble = 2;  ///< input, output, resource or usage error

/// Runs the program: parses the command line and performs the surface computation, `diff` or
/// `measure`.
/// Prints results to standard output, and errors, warnings and the progress bar to standard error.
/// Throws nothing. Returns the exit code.
int run_command(int argc, char** argv);

}  // namespace eses::detail::cli
