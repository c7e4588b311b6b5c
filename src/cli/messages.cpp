#include "cli/messages.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <variant>

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

[[noreturn]] void fail_to_print(int error) {
  throw Error(
      formatted("cannot write to standard output: {}", std::generic_category().message(error)));
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
  const std::string line = formatted("eses-blocks: {}: {}\n", kind, one_line(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void print_out_of_memory() { std::fputs("eses-blocks: error: out of memory\n", stderr); }

// Warnings are printed before the computation starts.
void warn(const Report& report) {
  const std::vector<std::string> lines = warnings(report);
  if (report.options.strict && !lines.empty()) throw StrictError{lines};
  if (report.options.quiet) return;
  for (const std::string& line : lines) print_message("warning", line);
}

void announce(const Report& report) {
  if (report.options.quiet) return;
  if (!report.options.json) {
    print(plan_text(report));
  } else if (isatty(STDERR_FILENO) == 1) {
    std::fputs(plan_text(report).c_str(), stderr);
  }
}

std::string final_text(const Report& report) {
  if (report.options.json) return json_text(report);
  // Scripts search for these two lines, so faulty results must not be printed.
  const std::string result = has_faults(report.summary) ? "" : result_text(report.summary);
  return report.options.quiet ? result : result + summary_text(report);
}

void warn_if_empty(const Report& report) {
  const Parameters& parameters = report.options.parameters;
  const bool is_whole =
      std::holds_alternative<std::monostate>(parameters.part) && !parameters.has_custom_grid();
  if (report.summary.inside_points > 0 || !is_whole) return;
  if (!report.options.quiet)
    print_message("warning", "no grid point is inside the surface; use a smaller spacing");
}

}  // namespace eses::detail::cli
