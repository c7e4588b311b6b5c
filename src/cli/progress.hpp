#pragma once
/// A progress bar on standard error.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace eses::detail::cli {

/// The numbers of finished and of all steps of one kind, such as `blocks`.
struct Progress {
  std::int64_t done = 0, total = 0;
  std::string_view steps = "blocks";
};

/// Returns a line of at most `width` columns: percentage, bar, steps and, if known, remaining time.
std::string progress_line(const Progress& progress, std::optional<double> seconds_left,
                          std::size_t width);

/// A progress bar, which is removed when the object is destroyed.
class ProgressBar {
 public:
  ProgressBar() = default;
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Draws the bar. The kind of steps may change between calls.
  void show(const Progress& progress);

  /// Returns whether standard error is a terminal on which a bar can be drawn.
  static bool is_possible();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<double> seconds_left(const Progress& progress) const;

  std::optional<Clock::time_point> start_;  // start of steps of the current kind
  std::string_view steps_;
  Clock::time_point last_drawn_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace eses::detail::cli
