#pragma once
/// Messages and the progress bar on standard output and standard error, and parts of their texts.

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
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

/// A progress bar, which is removed when the object is destroyed. It draws nothing if standard
/// error is no terminal on which a bar can be drawn.
class ProgressBar {
 public:
  explicit ProgressBar(bool is_wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows the number of finished steps, such as `files`.
  void show(std::int64_t done, std::int64_t total, std::string_view steps);
  /// Shows the number of finished blocks. It is also called during the verification, with an
  /// unchanged number; the bar then continues to show the other steps.
  void show_blocks(std::int64_t done, std::int64_t total);
  /// Shows the time since the first call, for work of unknown length, such as `measuring: 12 s`.
  void show_time(std::string_view work);
  /// Removes the bar until the next call, so that a message can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(std::string line);

  bool is_shown_;
  std::int64_t blocks_done_ = 0;
  std::string_view steps_;   // kind of the shown steps; empty before the first ones
  Clock::time_point start_;  // start of the steps of this kind
  Clock::time_point last_drawn_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace eses::detail::cli
