#pragma once
/// A progress bar on standard error.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace eses::detail::cli {

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
