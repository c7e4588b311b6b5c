#include "cli/messages.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail::cli {
namespace {

[[noreturn]] void fail_to_print(int error) {
  const std::string message =
      formatted("cannot write to standard output: {}", std::generic_category().message(error));
  if (error == EPIPE) throw ClosedPipe(message);
  throw Error(message);
}

/// Whether standard error is a terminal that can move its cursor and show colours.
bool is_full_terminal() {
  const char* const terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

/// Whether messages have colours, which the user may refuse (https://no-color.org).
bool shows_color() {
  const char* const refused = std::getenv("NO_COLOR");
  return (refused == nullptr || *refused == '\0') && is_full_terminal();
}

// --- the progress bar ----------------------------------------------------------------------------

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

/// Returns the numbers of steps and, if it can be estimated, the remaining time.
std::string counts_text(std::int64_t done, std::int64_t total, std::string_view steps,
                        double elapsed) {
  const std::string all = formatted("{}", total);
  std::string text = formatted(" {:>{}}/{} {}", done, all.size(), all, steps);
  if (done <= 0) return text;
  const double left = elapsed * static_cast<double>(total - done) / static_cast<double>(done);
  if (left < max_estimate) text += formatted(", {} left", clock_text(left));
  return text;
}

std::string bar_text(double fraction, std::size_t length) {
  const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(length));
  return " [" + std::string(filled, '#') + std::string(length - filled, ' ') + "]";
}

/// Returns a line of at most `width` columns: percentage, bar and counts.
std::string progress_line(double fraction, const std::string& counts, std::size_t width) {
  const std::string percent = formatted("{:3}%", static_cast<int>(100 * fraction));
  const std::size_t needed = percent.size() + counts.size() + bar_text(0, 0).size();
  if (width < needed + narrowest_bar) return percent.substr(0, width);
  return percent + bar_text(fraction, std::min(width - needed, widest_bar)) + counts;
}

}  // namespace

void print(std::string_view text) {
  errno = 0;
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail_to_print(errno);
}

void require_standard_output() {
  const int flags = fcntl(STDOUT_FILENO, F_GETFL);
  if (flags == -1 || (flags & O_ACCMODE) == O_RDONLY) fail_to_print(EBADF);
}

void print_message(std::string_view kind, std::string_view message) {
  const std::string_view color = !shows_color()    ? ""
                                 : kind == "error" ? "\x1b[1;31m"
                                                   : "\x1b[1;33m";
  const std::string line = formatted("eses-blocks: {}{}:{} {}\n", color, kind,
                                     color.empty() ? "" : "\x1b[0m", one_line(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void print_out_of_memory() { std::fputs("eses-blocks: error: out of memory\n", stderr); }

std::string message_of(const std::exception& error) {
  std::string message = error.what();
  const auto* const hinted = dynamic_cast<const Hints*>(&error);
  if (hinted == nullptr || hinted->hints().empty()) return message;
  std::vector<std::string> options;
  for (std::string option : hinted->hints()) {
    const auto name_end = std::find(option.begin(), option.end(), ' ');
    std::replace(option.begin(), name_end, '_', '-');
    options.push_back("--" + option);
  }
  return formatted("{} ({})", message, fmt::join(options, ", "));
}

std::string one_line(std::string_view text) {
  std::string line(text);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  std::replace_if(line.begin(), line.end(), is_control, '?');
  return line;
}

ProgressBar::ProgressBar(bool is_wanted) : is_shown_(is_wanted && is_full_terminal()) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (columns_drawn_ > 0) write_stderr(formatted("\r{:{}}\r", "", columns_drawn_));
  columns_drawn_ = 0;
}

void ProgressBar::show_blocks(std::int64_t done, std::int64_t total) {
  constexpr std::string_view steps = "blocks";
  if (done == blocks_done_ && !steps_.empty() && steps_ != steps) return;
  blocks_done_ = done;
  show(done, total, steps);
}

void ProgressBar::show_time(std::string_view work) {
  if (!is_shown_) return;
  const Clock::time_point now = Clock::now();
  if (steps_.empty()) start_ = last_drawn_ = now;
  steps_ = work;
  if (now - last_drawn_ < std::chrono::seconds(1)) return;
  last_drawn_ = now;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - start_).count();
  draw(formatted("{}: {} s", work, seconds).substr(0, terminal_width() - 1));
}

void ProgressBar::show(std::int64_t done, std::int64_t total, std::string_view steps) {
  if (!is_shown_) return;
  const Clock::time_point now = Clock::now();
  // Nothing is drawn at the first call, so that short runs show no bar.
  if (steps_.empty()) last_drawn_ = now;
  // The estimate of the remaining time excludes the time before the first step.
  if (done == 0 || steps != steps_) start_ = now;
  steps_ = steps;
  if (now - last_drawn_ < redraw_interval) return;
  last_drawn_ = now;
  const std::chrono::duration<double> elapsed = now - start_;
  const double fraction =
      total > 0 ? std::clamp(static_cast<double>(done) / static_cast<double>(total), 0., 1.) : 1;
  // Some terminals wrap the line after a character in the last column.
  draw(progress_line(fraction, counts_text(done, total, steps, elapsed.count()),
                     terminal_width() - 1));
}

// Replaces the line that was drawn before.
void ProgressBar::draw(std::string line) {
  const std::size_t columns = line.size();
  if (columns < columns_drawn_) line.resize(std::min(columns_drawn_, terminal_width() - 1), ' ');
  columns_drawn_ = columns;
  write_stderr("\r" + line);
}

}  // namespace eses::detail::cli
