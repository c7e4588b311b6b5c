#pragma once
/// A progress bar on standard error.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace eses::detail::cli {

/// Steps of one kind, `blocks` or others, done so far out of all.
struct Progress {
  std::int64_t done = 0, total = 0;
  std::string_view steps = "blocks";
};

/// One line of at most `width` columns: percentage, bar, steps and time left, as far as known.
std::string progress_line(const Progress& progress, std::optional<double> seconds_left,
                          std::size_t width);

/// Draws over itself while it lives and is gone afterwards, also when an exception ends the run.
class ProgressBar {
 public:
  ProgressBar() = default;
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// The kind of steps may change.
  void show(const Progress& progress);

  /// Whether standard error is a terminal that a bar can be drawn on.
  static bool is_possible();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<double> seconds_left(const Progress& progress) const;

  std::optional<Clock::time_point> start_;  // of these steps
  std::string_view steps_;
  Clock::time_point last_drawn_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace eses::detail::cli
