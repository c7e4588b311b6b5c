#include "cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "cli/diff_options.hpp"
#include "cli/diff_report.hpp"
#include "cli/interruption.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/report.hpp"
#include "diff/compare_directories.hpp"
#include "eses/error.hpp"
#include "eses/molecule.hpp"
#include "eses/read_atoms.hpp"
#include "eses/run.hpp"
#include "io/output_directory.hpp"
#include "run/output_files.hpp"
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

[[noreturn]] void fail_to_print(int error) {
  throw Error(
      fmt::format("cannot write to standard output: {}", std::generic_category().message(error)));
}

/// Flushes, so that a full disk or a closed pipe is noticed here and not after the exit code.
void print(std::string_view text) {
  errno = 0;
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail_to_print(errno);
}

void complain(std::string_view kind, std::string_view message) {
  const std::string line = fmt::format("eses-blocks: {}: {}\n", kind, one_line(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

// Needs none itself.
void complain_about_memory() { std::fputs("eses-blocks: error: out of memory\n", stderr); }

// CLI11 promises not to throw where it allocates; nothing else should come here.
[[noreturn]] void end_on_uncaught_exception() {
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    complain_about_memory();
    _exit(exit_failure);
  } catch (...) {
  }
  std::abort();
}

/// Warnings of a run in which they are errors.
struct StrictError {
  std::vector<std::string> lines;
};

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

Summary run_with_progress(const Molecule& molecule, const Options& options, const Plan& plan) {
  std::optional<ProgressBar> bar;
  if (!options.quiet && ProgressBar::is_possible()) bar.emplace();
  InterruptibleRun interruptible(temporary_paths(options.outputs, options.output_directory),
                                 lock_paths(options.outputs, options.output_directory));
  // That all blocks are solved is told again while checks go on.
  bool is_verifying = false;
  const auto show_blocks = [&](std::int64_t done, std::int64_t total) {
    interruptible.check();
    if (bar && !is_verifying) bar->show({done, total});
  };
  const auto show_checks = [&](std::int64_t done, std::int64_t total) {
    is_verifying = true;
    if (bar) bar->show({done, total, "checks"});
  };
  Summary summary = run(molecule, plan, options.outputs, options.output_directory,
                        {.progress = show_blocks, .verification = show_checks});
  interruptible.check();
  return summary;
}

std::string final_text(const Report& report) {
  if (report.options.json) return json_text(report);
  // Callers that look for the two lines only must not find numbers that are wrong.
  const std::string result = has_faults(report.summary) ? "" : result_text(report.summary);
  return report.options.quiet ? result : result + summary_text(report);
}

// Better now than after a long run.
void require_standard_output() {
  const int flags = fcntl(STDOUT_FILENO, F_GETFL);
  if (flags == -1 || (flags & O_ACCMODE) == O_RDONLY) fail_to_print(EBADF);
}

void refuse_to_lose_input(const Options& options) {
  const auto refuse_if_input = [&](const std::string& file, std::string_view fate) {
    std::error_code error;  // as where there is no such file yet
    if (std::filesystem::equivalent(options.input, file, error) && !error)
      throw Error(fmt::format("{} is the input, and would be {}", file, fate));
  };
  for (const std::string& file : final_paths(options.outputs, options.output_directory))
    refuse_if_input(file, "overwritten");
  for (const std::string& file : stale_paths(options.outputs, options.output_directory))
    refuse_if_input(file, options.outputs.gzip ? "removed, as a gzipped file takes its place"
                                               : "removed, as a plain file takes its place");
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

// `lines` are those of the atoms in the file.
Report plan_report(const Molecule& molecule, std::span<const std::uint64_t> lines,
                   const Options& options) {
  Report report;
  report.options = options;
  report.atoms = molecule.atoms().size();
  report.findings = describe(molecule.oddities(), lines, options.input);
  report.plan = make_plan(molecule, options.parameters, options.outputs);
  require_memory_for_reading(options);
  report.disk = require_disk_space(report.plan, options.outputs, options.output_directory);
  return report;
}

/// Labels take more memory than their atoms: they stay only where they are written.
void choose_labels(const Options& options, std::vector<AtomLabel>& labels) {
  const auto& mesh = options.outputs.mesh;
  if (options.outputs.residues && labels.empty())
    throw Error(
        fmt::format("{}: areas by residue (--write residues) need a PQR file; xyzr does not "
                    "tell chains and residues",
                    options.input.string()));
  if (!options.outputs.residues && !(mesh && mesh_format(mesh->file) == MeshFormat::ply))
    std::vector<AtomLabel>().swap(labels);
}

int compute(const Options& options) {
  require_standard_output();
  refuse_to_lose_input(options);
  require_places(options.outputs, options.output_directory);
  NumberedAtoms input = read_numbered_atoms(options.input, options.format);
  choose_labels(options, input.labels);
  const Molecule molecule(std::move(input.atoms), std::move(input.labels));
  Report report = plan_report(molecule, input.lines, options);
  if (options.dry_run) {
    print(options.json ? json_text(report) : plan_text(report));
    warn(report);
    return exit_done;
  }
  if (options.strict) warn(report);
  announce(report);
  if (!options.strict) warn(report);
  report.summary = run_with_progress(molecule, options, report.plan);
  report.peak_memory_bytes = peak_memory();
  print(final_text(report));
  const bool is_part = options.parameters.region || options.parameters.blocks;
  if (report.summary.inside_points == 0 && !is_part && !options.quiet)
    complain("warning", "no grid point is inside the molecule; a smaller spacing would show it");
  for (const std::string& fault : fault_lines(report.summary)) complain("error", fault);
  return exit_code(report.summary);
}

int compute_surface(int argc, char** argv) {
  end_on_signals();
  const std::variant<Options, Notice> request = parse_command_line(argc, argv);
  if (const auto* const notice = std::get_if<Notice>(&request)) {
    print(notice->text);
    return exit_done;
  }
  return compute(std::get<Options>(request));
}

int compare_files(int argc, char** argv) {
  const std::variant<DiffOptions, Notice> request = parse_diff_command_line(argc, argv);
  if (const auto* const notice = std::get_if<Notice>(&request)) {
    print(notice->text);
    return exit_done;
  }
  const auto& options = std::get<DiffOptions>(request);
  const Differences found = compare_directories(options.directories, options.tolerance);
  print(options.json ? diff_json_text(options, found) : diff_text(options, found));
  return found.same() ? exit_done : exit_different;
}

/// What the program is asked to do, up to its exit code, and what goes with its failure.
struct Task {
  int (*perform)(int argc, char** argv);
  std::string_view help;
  int failure_code;
};

constexpr Task surface_task{compute_surface, "eses-blocks --help", exit_failure};
constexpr Task diff_task{compare_files, "eses-blocks diff --help", exit_trouble};

// Throws std::bad_alloc and nothing else.
int perform(const Task& task, int argc, char** argv) {
  const auto fail = [&task](std::string_view message) {
    complain("error", message);
    return task.failure_code;
  };
  try {
    return task.perform(argc, argv);
  } catch (const UsageError& error) {
    complain("error", error.what());
    std::fputs(fmt::format("Try '{}'.\n", task.help).c_str(), stderr);
    return exit_usage;
  } catch (const StrictError& error) {
    for (const std::string& line : error.lines) complain("error", line);
    return exit_failure;
  } catch (const Interrupted& interrupted) {
    return interrupted.exit_code;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return fail(error.what());
  } catch (...) {
    return fail("unknown error");
  }
}

}  // namespace

int exit_code(const Summary& summary) { return has_faults(summary) ? exit_failure : exit_done; }

int run_command(int argc, char** argv) {
  reserve_standard_streams();
  std::set_terminate(end_on_uncaught_exception);
  // A reader that has gone away, or a file that may not grow, is a write error like others.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  const bool is_diff = argc > 1 && std::string_view(argv[1]) == "diff";
  const Task& task = is_diff ? diff_task : surface_task;
  try {
    return is_diff ? perform(task, argc - 1, argv + 1) : perform(task, argc, argv);
  } catch (const std::bad_alloc&) {
    complain_about_memory();
    return task.failure_code;
  }
}

}  // namespace eses::cli
