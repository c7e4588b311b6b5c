#pragma once
/// The commands of the program `eses-blocks`: how they are called, and how they end.

#include <stdexcept>
#include <string>
#include <vector>

namespace eses::detail {
class Processes;
}

namespace eses::detail::cli {

/// Exit codes of `run_command`.
inline constexpr int exit_done = 0;
inline constexpr int exit_failure = 1;  ///< input, output or resource error, or faults found
inline constexpr int exit_usage = 2;    ///< error in the command line

/// Exit codes of `eses-blocks diff`, which are the codes of diff(1); 0 means that there are no
/// differences.
inline constexpr int exit_different = 1;
inline constexpr int exit_trouble = 2;  ///< input, output, resource or usage error

/// The text of `--help` or `--version`, which is printed instead of starting a command.
struct Notice {
  std::string text;
};

/// An error in the command line. `what()` names the option, its value and the expected value.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The warnings of a run with --strict.
struct StrictError {
  std::vector<std::string> lines;
};

using Arguments = std::vector<std::string>;

/// The commands. Each parses its arguments, computes, and prints its results. They return the exit
/// code. They throw Notice, UsageError, StrictError, Interrupted (interruption.hpp), and
/// std::exception for other errors. All processes must call `perform_surface`; the first one calls
/// the others.
int perform_surface(const Arguments& arguments, const Processes& processes);
int perform_diff(const Arguments& arguments);
int perform_interface(const Arguments& arguments);
int perform_measure(const Arguments& arguments);
int perform_msms(const Arguments& arguments);
int perform_pdb_to_xyzr(const Arguments& arguments);
int perform_pdb_to_xyzrn(const Arguments& arguments);

/// Runs the program: performs the command that the command line chooses. Prints results to standard
/// output, and errors, warnings and the progress bar to standard error. Throws nothing. Returns the
/// exit code.
int run_command(int argc, char** argv);

}  // namespace eses::detail::cli
