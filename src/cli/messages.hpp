#pragma once
/// Messages of the program on standard output and standard error, and parts of their texts.

#include <concepts>
#include <exception>
#include <string>
#include <string_view>

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {

/// The reader of standard output has ended.
class ClosedPipe : public Error {
  using Error::Error;
};

/// Prints a text to standard output and flushes it. Throws Error if that fails, for example because
/// of a full disk, and ClosedPipe for a closed pipe.
void print(std::string_view text);

/// Throws Error if standard output cannot be written. Called before a run starts.
void require_standard_output();

/// Prints a line to standard error. `kind` is `error`, `warning` or `note`.
void print_message(std::string_view kind, std::string_view message);
/// Prints the message about insufficient memory without allocating any.
void print_out_of_memory();

/// Returns the message of an error, with its hints as options, such as ` (--max-memory 20M)`.
std::string message_of(const std::exception& error);

/// Returns `text` as a single line, in which `?` replaces control characters.
std::string one_line(std::string_view text);

/// Returns a count with its noun, such as `1 edge` or `2 edges`.
std::string counted(std::integral auto count, std::string_view noun) {
  return formatted("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace eses::detail::cli
