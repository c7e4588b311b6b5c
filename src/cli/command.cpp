#include "cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/diff_options.hpp"
#include "cli/diff_report.hpp"
#include "cli/interruption.hpp"
#include "cli/measure_command.hpp"
#include "cli/measure_options.hpp"
#include "cli/messages.hpp"
#include "cli/msms_command.hpp"
#include "cli/msms_options.hpp"
#include "cli/options.hpp"
#include "cli/surface_command.hpp"
#include "cli/usage.hpp"
#include "cli/xyzr_command.hpp"
#include "diff/compare_directories.hpp"
#include "distributed/launcher.hpp"
#include "distributed/processes.hpp"
#include "eses/error.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/resources.hpp"

namespace eses::detail::cli {
namespace {

/// Opens /dev/null in place of closed standard streams. Otherwise the next opened file would get
/// the descriptor, and messages would be written to an output file. The descriptors have the wrong
/// direction, so that every use of them still fails.
void reserve_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    // open() returns the lowest free descriptor, which is `stream`: all lower ones are in use.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

// Some functions of CLI11 are noexcept but allocate memory, so std::bad_alloc can end here.
[[noreturn]] void end_on_uncaught_exception() {
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    print_out_of_memory();
    _exit(exit_failure);
  } catch (...) {
  }
  std::abort();
}

/// Throws Error if several processes were started together but cannot communicate. They usually
/// have the same command line and would write the same files.
void refuse_same_files(const Options& options, const Processes& processes) {
  const int launched = launched_processes();
  if (launched == 1 || processes.count() > 1 || options.independent || options.dry_run) return;
  const bool has_files = !output_paths(options.outputs, options.output_directory).final.empty();
  if (!options.resume && !has_files) return;
  throw Error(
      formatted("started as one of {} processes that would all write the same files; to share "
                "one run, {}; for separate runs, use --independent and separate output "
                "directories",
                launched, Processes::advice()));
}

using Arguments = std::vector<std::string>;

int perform_surface(const Arguments& arguments, const Processes& processes) {
  end_on_signals();
  const Options options = parse_arguments(arguments);
  refuse_same_files(options, processes);
  return compute_surface(options, processes);
}

int compare_files(const Arguments& arguments, const Processes& processes) {
  if (!processes.is_first()) return exit_done;  // one process performs the comparison
  const DiffOptions options = parse_diff_arguments(arguments);
  const Differences found = compare_directories(options.directories, options.tolerance);
  print(options.json ? diff_json_text(options, found) : diff_text(options, found));
  return found.same() ? exit_done : exit_different;
}

int perform_measure(const Arguments& arguments, const Processes& processes) {
  if (!processes.is_first()) return exit_done;  // one process measures all files
  end_on_signals();
  return measure_files(parse_measure_arguments(arguments));
}

int perform_msms(const Arguments& arguments, const Processes& processes) {
  if (!processes.is_first()) return exit_done;  // one process computes the surface
  end_on_signals();
  run_msms(parse_msms_arguments(arguments));
  return exit_done;
}

template <bool has_names>
int perform_xyzr(const Arguments& arguments, const Processes& processes) {
  if (processes.is_first()) print_spheres(has_names, arguments);
  return exit_done;
}

/// Returns the message of an error, with its hints as options, such as ` (--max-memory 20M)`.
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

/// A command of the program.
struct Command {
  int (*perform)(const Arguments& arguments, const Processes& processes);
  std::string_view help;
  int failure_code;
};

constexpr Command surface_command{perform_surface, "eses-blocks --help", exit_failure};
constexpr Command diff_command{compare_files, "eses-blocks diff --help", exit_trouble};
constexpr Command measure_command{perform_measure, "eses-blocks measure --help", exit_failure};
constexpr Command msms_command{perform_msms, "eses-blocks msms --help", exit_failure};
constexpr Command xyzr_command{perform_xyzr<false>, "eses-blocks pdb_to_xyzr --help", exit_failure};
constexpr Command xyzrn_command{perform_xyzr<true>, "eses-blocks pdb_to_xyzrn --help",
                                exit_failure};

/// Returns the command with the interface of MSMS or one of its scripts; null if `name` names none.
const Command* msms_command_named(std::string_view name) {
  if (name == "msms") return &msms_command;
  if (name == "pdb_to_xyzr") return &xyzr_command;
  if (name == "pdb_to_xyzrn") return &xyzrn_command;
  return nullptr;
}

/// Returns the command that the first argument names; null if it names none.
const Command* named_command(std::string_view name) {
  if (name == "diff") return &diff_command;
  if (name == "measure") return &measure_command;
  return msms_command_named(name);
}

/// Returns the command that a link to the program names, such as eses-msms; null if it names none.
const Command* linked_command(std::string_view path) {
  constexpr std::string_view prefix = "eses-";
  std::string_view name = path.substr(path.rfind('/') + 1);
  if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  return msms_command_named(name);
}

/// Ends the other processes after a failure in this process only. Returns the exit code.
int end_all(const Processes& processes, int code) {
  if (processes.count() > 1) processes.abort(code);
  return code;
}

int perform_or_notify(const Command& command, const Arguments& arguments,
                      const Processes& processes) try {
  return command.perform(arguments, processes);
} catch (const Notice& notice) {
  if (processes.is_first()) print(notice.text);
  return exit_done;
}

// Performs a command and prints its errors. Returns the exit code. Throws std::bad_alloc and
// nothing else.
int perform(const Command& command, const Arguments& arguments, const Processes& processes) {
  const auto fail = [&](std::string_view message) {
    processes.become_reporter();
    print_message("error", message);
    return end_all(processes, command.failure_code);
  };
  try {
    return perform_or_notify(command, arguments, processes);
  } catch (const UsageError& error) {
    if (!processes.is_first()) return exit_usage;
    print_message("error", error.what());
    std::fputs(formatted("Try '{}'.\n", command.help).c_str(), stderr);
    return exit_usage;
  } catch (const StrictError& error) {
    for (const std::string& line : error.lines) print_message("error", line);
    return exit_failure;
  } catch (const SharedError& error) {
    if (processes.is_first()) print_message("error", message_of(error));
    return command.failure_code;
  } catch (const Interrupted& interrupted) {
    return end_all(processes, interrupted.exit_code);
  } catch (const std::bad_alloc&) {
    if (processes.count() == 1) throw;
    processes.become_reporter();
    print_out_of_memory();
    return end_all(processes, command.failure_code);
  } catch (const std::exception& error) {
    return fail(message_of(error));
  } catch (...) {
    return fail("unknown error");
  }
}

// Starts MPI unless --independent is given, and performs a command. Returns the exit code. Throws
// std::bad_alloc and nothing else.
int perform(const Command& command, int argc, char** argv) {
  const auto arguments = [&] { return Arguments(argv + std::min(argc, 1), argv + argc); };
  std::optional<Processes> processes;
  try {
    require_stack();
    if (asks_to_be_independent(arguments()))
      processes.emplace();
    else
      processes.emplace(argc, argv);
  } catch (const Error& error) {
    print_message("error", error.what());
    return command.failure_code;
  }
  return perform(command, arguments(), *processes);
}

}  // namespace

int run_command(int argc, char** argv) {
  reserve_standard_streams();
  std::set_terminate(end_on_uncaught_exception);
  // Closed pipes and the file size limit are then reported as write errors.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  const Command* const linked = argc > 0 ? linked_command(argv[0]) : nullptr;
  const Command* const named = linked == nullptr && argc > 1 ? named_command(argv[1]) : nullptr;
  const Command& command = linked != nullptr  ? *linked
                           : named != nullptr ? *named
                                              : surface_command;
  try {
    return named != nullptr ? perform(command, argc - 1, argv + 1) : perform(command, argc, argv);
  } catch (const std::bad_alloc&) {
    print_out_of_memory();
    return command.failure_code;
  }
}

}  // namespace eses::detail::cli
