#include "cli/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds redraw_interval{100};
constexpr std::size_t widest_bar = 60;
constexpr std::size_t narrowest_bar = 5;
constexpr double max_estimate = 1000 * 3600.0;  // longer estimates are not shown

std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

void write_stderr(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60;
  if (hours > 0) return formatted("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return formatted("{}:{:02}", minutes, whole % 60);
}

std::string counts_text(const Progress& progress, std::optional<double> seconds_left) {
  const std::string all = formatted("{}", progress.total);
  std::string text = formatted(" {:>{}}/{} {}", progress.done, all.size(), all, progress.steps);
  if (seconds_left) text += formatted(", {} left", clock_text(*seconds_left));
  return text;
}

std::string bar_text(double fraction, std::size_t length) {
  const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(length));
  return " [" + std::string(filled, '#') + std::string(length - filled, ' ') + "]";
}

}  // namespace

std::string progress_line(const Progress& progress, std::optional<double> seconds_left,
                          std::size_t width) {
  const auto [done, total, steps] = progress;
  const double fraction =
      total > 0 ? std::clamp(static_cast<double>(done) / static_cast<double>(total), 0., 1.) : 1;
  const std::string percent = formatted("{:3}%", static_cast<int>(100 * fraction));
  const std::string counts = counts_text(progress, seconds_left);
  const std::size_t needed = percent.size() + counts.size() + bar_text(0, 0).size();
  if (width < needed + narrowest_bar) return percent.substr(0, width);
  return percent + bar_text(fraction, std::min(width - needed, widest_bar)) + counts;
}

ProgressBar::~ProgressBar() {
  if (columns_drawn_ > 0) write_stderr(formatted("\r{:{}}\r", "", columns_drawn_));
}

void ProgressBar::show(const Progress& progress) {
  const Clock::time_point now = Clock::now();
  // Nothing is drawn at the first call, so that short runs show no bar.
  if (!start_) last_drawn_ = now;
  // The estimate of the remaining time excludes the time before the first step.
  if (!start_ || progress.done == 0 || progress.steps != steps_) start_ = now;
  steps_ = progress.steps;
  if (now - last_drawn_ < redraw_interval) return;
  last_drawn_ = now;
  // Some terminals wrap the line after a character in the last column.
  const std::size_t width = terminal_width() - 1;
  std::string line = progress_line(progress, seconds_left(progress), width);
  const std::size_t columns = line.size();
  if (columns < columns_drawn_) line.resize(std::min(columns_drawn_, width), ' ');
  columns_drawn_ = columns;
  write_stderr("\r" + line);
}

std::optional<double> ProgressBar::seconds_left(const Progress& progress) const {
  const auto [done, total, steps] = progress;
  if (done <= 0) return std::nullopt;
  const std::chrono::duration<double> elapsed = last_drawn_ - *start_;
  const double left =
      elapsed.count() * static_cast<double>(total - done) / static_cast<double>(done);
  return left < max_estimate ? std::optional(left) : std::nullopt;
}

bool ProgressBar::is_possible() {
  const char* const terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal && std::string_view(terminal) != "dumb";
}

}  // namespace eses::detail::cli
