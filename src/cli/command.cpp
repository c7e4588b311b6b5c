#include "cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>
#include <vector>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/report.hpp"
#include "eses/error.hpp"
#include "eses/oddities.hpp"
#include "eses/read_atoms.hpp"
#include "eses/run.hpp"
#include "run/resources.hpp"

namespace eses::cli {
namespace {

/// If a standard stream is closed, the next file that is opened takes its number, and text for
/// the terminal ends up in an output file. A descriptor of the wrong direction keeps the place
/// and still makes every use fail.
void reserve_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    // The lowest free number is `stream`, as those below it are in use.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

/// Flushes, so that a full disk or a closed pipe is noticed here and not after the exit code.
void print(std::string_view text) {
  errno = 0;
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw Error(
        fmt::format("cannot write to standard output: {}", std::generic_category().message(errno)));
  }
}

void complain(std::string_view kind, std::string_view message) {
  const std::string line = fmt::format("eses-blocks: {}: {}\n", kind, one_line(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

std::atomic<int> received_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // or a signal handler may not write it

/// Ends a run from its progress callback, so that its unfinished files are removed.
struct Interrupted {};

/// Warnings of a run in which they are errors.
struct StrictError {
  std::vector<std::string> lines;
};

/// The first signal ends the run in order, a second one at once.
void end_in_order_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { received_signal = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

/// Warnings come before the work, so that nobody waits for what he did not want.
void warn(const Report& report) {
  const std::vector<std::string> lines = warnings(report);
  if (report.options.strict && !lines.empty()) throw StrictError{lines};
  if (report.options.quiet) return;
  for (const std::string& line : lines) complain("warning", line);
}

void announce(const Report& report) {
  if (report.options.quiet) return;
  if (!report.options.json) {
    print(plan_text(report));
  } else if (isatty(STDERR_FILENO) == 1) {
    std::fputs(plan_text(report).c_str(), stderr);
  }
}

Summary run_with_progress(const std::vector<Atom>& atoms, const Options& options,
                          const Plan& plan) {
  std::optional<ProgressBar> bar;
  if (!options.quiet && ProgressBar::is_possible()) bar.emplace();
  return run(atoms, plan, options.outputs, options.output_directory,
             [&bar](std::int64_t done, std::int64_t total) {
               if (received_signal != 0) throw Interrupted();
               if (bar) bar->show(done, total);
             });
}

std::string final_text(const Report& report) {
  if (report.options.json) return json_text(report);
  const std::string result = result_text(report.summary);
  return report.options.quiet ? result : result + summary_text(report);
}

/// A file may have far more text than atoms.
void require_memory_for_reading(const Options& options) {
  const std::uint64_t limit = options.parameters.max_memory, peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw Error(
      fmt::format("{}: reading it has taken more memory than the limit allows; the smallest "
                  "that would do is --max-memory {}M",
                  options.input.string(), (peak >> 20) + 1));
}

Report plan_report(const NumberedAtoms& input, const Options& options) {
  Report report;
  report.options = options;
  report.atoms = input.atoms.size();
  report.findings = describe(find_oddities(input.atoms), input.lines, options.input);
  report.plan = make_plan(input.atoms, options.parameters, options.outputs);
  require_memory_for_reading(options);
  report.disk = require_disk_space(report.plan, options.output_directory);
  return report;
}

void compute(const Options& options) {
  const NumberedAtoms input = read_numbered_atoms(options.input, options.format);
  Report report = plan_report(input, options);
  if (options.dry_run) {
    print(options.json ? json_text(report) : plan_text(report));
    warn(report);
    return;
  }
  if (options.strict) warn(report);
  announce(report);
  if (!options.strict) warn(report);
  report.summary = run_with_progress(input.atoms, options, report.plan);
  report.peak_memory_bytes = peak_memory();
  print(final_text(report));
}

int fail(std::string_view message) {
  complain("error", message);
  return exit_failure;
}

}  // namespace

int run_command(int argc, char** argv) {
  reserve_standard_streams();
  end_in_order_on_signals();
  std::signal(SIGPIPE, SIG_IGN);  // a reader that has gone away is a write error like others
  try {
    const std::variant<Options, Notice> request = parse_command_line(argc, argv);
    if (const auto* const notice = std::get_if<Notice>(&request)) {
      print(notice->text);
    } else {
      compute(std::get<Options>(request));
    }
    return exit_done;
  } catch (const UsageError& error) {
    complain("error", error.what());
    std::fputs("Try 'eses-blocks --help'.\n", stderr);
    return exit_usage;
  } catch (const StrictError& error) {
    for (const std::string& line : error.lines) complain("error", line);
    return exit_failure;
  } catch (const Interrupted&) {
    return 128 + received_signal;
  } catch (const std::bad_alloc&) {
    return fail("out of memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  } catch (...) {
    return fail("unknown error");
  }
}

}  // namespace eses::cli
