#pragma once
/// Messages of the program on standard output and standard error.

#include <string>
#include <string_view>
#include <vector>

#include "cli/report.hpp"

namespace eses::detail::cli {

/// Prints a text to standard output and flushes it. Throws Error if that fails, for example because
/// of a full disk or a closed pipe.
void print(std::string_view text);

/// Throws Error if standard output cannot be written. Called before a run starts.
void require_standard_output();

/// Prints a line to standard error. `kind` is `error` or `warning`.
void print_message(std::string_view kind, std::string_view message);
/// Prints the message about insufficient memory without allocating any.
void print_out_of_memory();

/// The warnings of a run with --strict.
struct StrictError {
  std::vector<std::string> lines;
};

/// Prints the warnings, or throws StrictError with --strict.
void warn(const Report& report);

/// Prints the plan, unless --quiet is given.
void announce(const Report& report);

/// Returns the final report, as text or JSON.
std::string final_text(const Report& report);

/// Prints a warning if no point is inside the surface.
void warn_if_empty(const Report& report);

}  // namespace eses::detail::cli
