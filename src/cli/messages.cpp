#include "cli/messages.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "system/hints.hpp"

namespace eses::detail::cli {
namespace {

[[noreturn]] void fail_to_print(int error) {
  const std::string message =
      formatted("cannot write to standard output: {}", std::generic_category().message(error));
  if (error == EPIPE) throw ClosedPipe(message);
  throw Error(message);
}

/// Whether standard error is a terminal that shows colours, and the user has not refused them
/// (https://no-color.org).
bool shows_color() {
  const char* const refused = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return (refused == nullptr || *refused == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb" && isatty(STDERR_FILENO) == 1;
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

}  // namespace eses::detail::cli
