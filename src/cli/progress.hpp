#pragma once
/// A progress bar on standard error.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace eses::cli {

/// One line of at most `width` columns: percentage, bar, blocks and time left, as far as known.
std::string progress_line(std::int64_t done, std::int64_t total, std::optional<double> seconds_left,
                          std::size_t width);

/// Draws over itself while it lives and is gone afterwards, also when an exception ends the run.
class ProgressBar {
 public:
  ProgressBar() = default;
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::int64_t done, std::int64_t total);

  /// Whether standard error is a terminal that a bar can be drawn on.
  static bool is_possible();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<double> seconds_left(std::int64_t done, std::int64_t total) const;

  std::optional<Clock::time_point> start_;  // of the blocks
  Clock::time_point last_drawn_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace eses::cli
