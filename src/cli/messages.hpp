#pragma once
/// What the program says, and where.

#include <string>
#include <string_view>
#include <vector>

#include "cli/report.hpp"

namespace eses::detail::cli {

/// Prints, and flushes, so that a full disk or a closed pipe is noticed here and not after the exit
/// code: throws Error.
void print(std::string_view text);

/// Throws Error if nothing can be printed: better now than after a long run.
void require_standard_output();

/// A line on standard error.
void print_message(std::string_view kind, std::string_view message);
/// Needs no memory itself.
void print_out_of_memory();

/// Warnings of a run in which they are errors.
struct StrictError {
  std::vector<std::string> lines;
};

/// Prints warnings, or throws StrictError with them if they are to be errors.
void warn(const Report& report);

/// Prints the plan, unless the user wants to hear less.
void announce(const Report& report);

/// What is printed when all is done: text or JSON.
std::string final_text(const Report& report);

/// A warning where not a single point is inside.
void warn_if_empty(const Report& report);

}  // namespace eses::detail::cli
