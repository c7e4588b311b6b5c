#include "cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
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
#include "eses/read_atoms.hpp"
#include "eses/run.hpp"

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

// Linux counts what the parent held before it became this program towards ru_maxrss, but not
// towards VmHWM.
std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    std::uint64_t kilobytes = 0;
    if (key == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::atomic<int> received_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // or a signal handler may not write it

/// Ends a run from its progress callback, so that its unfinished files are removed.
struct Interrupted {};

/// The first signal ends the run in order, a second one at once.
void end_in_order_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { received_signal = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

void announce(const Report& report) {
  if (report.options.quiet) return;
  if (!report.options.json) {
    print(plan_text(report));
  } else if (isatty(STDERR_FILENO) == 1) {
    std::fputs(plan_text(report).c_str(), stderr);
  }
  if (report.plan.cut_depth > 0) complain("warning", cut_warning(report));
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
  // Callers that look for the two lines only must not find numbers that are wrong.
  const std::string result = has_faults(report.summary) ? "" : result_text(report.summary);
  return report.options.quiet ? result : result + summary_text(report);
}

int compute(const Options& options) {
  const std::vector<Atom> atoms = read_atoms(options.input, options.format);
  Report report;
  report.options = options;
  report.atoms = atoms.size();
  report.plan = make_plan(atoms, options.parameters, options.outputs);
  announce(report);
  report.summary = run_with_progress(atoms, options, report.plan);
  report.peak_memory_bytes = peak_memory_bytes();
  print(final_text(report));
  for (const std::string& fault : fault_lines(report.summary)) complain("error", fault);
  return exit_code(report.summary);
}

int fail(std::string_view message) {
  complain("error", message);
  return exit_failure;
}

}  // namespace

int exit_code(const Summary& summary) { return has_faults(summary) ? exit_failure : exit_done; }

int run_command(int argc, char** argv) {
  reserve_standard_streams();
  end_in_order_on_signals();
  std::signal(SIGPIPE, SIG_IGN);  // a reader that has gone away is a write error like others
  try {
    const std::variant<Options, Notice> request = parse_command_line(argc, argv);
    if (const auto* const notice = std::get_if<Notice>(&request)) {
      print(notice->text);
      return exit_done;
    }
    return compute(std::get<Options>(request));
  } catch (const UsageError& error) {
    complain("error", error.what());
    std::fputs("Try 'eses-blocks --help'.\n", stderr);
    return exit_usage;
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
