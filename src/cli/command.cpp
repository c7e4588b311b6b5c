#include "cli/command.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string_view>

#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/surface_options.hpp"
#include "eses/error.hpp"
#include "system/formatted.hpp"
#include "system/processes.hpp"
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

/// A command of the program.
struct Command {
  std::string_view name;  ///< first argument that chooses the command; empty for the surface
  int (*perform)(const Arguments& arguments) = nullptr;  ///< null for the surface
  int failure_code = exit_failure;
  bool only_prints = false;  ///< whether a closed pipe ends it quietly, as a filter
  bool is_linked = false;    ///< whether a link to the program, such as eses-msms, chooses it
};

constexpr int closed_pipe_code = 128 + SIGPIPE;

constexpr Command surface_command;
constexpr std::array named_commands{
    Command{.name = "diff", .perform = perform_diff, .failure_code = exit_trouble},
    Command{.name = "interface", .perform = perform_interface, .only_prints = true},
    Command{.name = "measure", .perform = perform_measure, .only_prints = true},
    Command{.name = "msms", .perform = perform_msms, .is_linked = true},
    Command{.name = "pdb_to_xyzr",
            .perform = perform_pdb_to_xyzr,
            .only_prints = true,
            .is_linked = true},
    Command{.name = "pdb_to_xyzrn",
            .perform = perform_pdb_to_xyzrn,
            .only_prints = true,
            .is_linked = true},
};

/// Returns the command that the first argument names; null if it names none.
const Command* named_command(std::string_view name) {
  const auto* const found = std::ranges::find(named_commands, name, &Command::name);
  return found == named_commands.end() ? nullptr : found;
}

/// Returns the command that a link to the program names, such as eses-msms; null if it names none.
const Command* linked_command(std::string_view path) {
  constexpr std::string_view prefix = "eses-";
  std::string_view name = path.substr(path.rfind('/') + 1);
  if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  const Command* const command = named_command(name);
  return command != nullptr && command->is_linked ? command : nullptr;
}

/// Ends the other processes after a failure in this process only. Returns the exit code.
int end_all(const Processes& processes, int code) {
  if (processes.count() > 1) processes.abort(code);
  return code;
}

int perform_or_notify(const Command& command, const Arguments& arguments,
                      const Processes& processes) try {
  if (command.perform == nullptr) return perform_surface(arguments, processes);
  return processes.is_first() ? command.perform(arguments) : exit_done;
} catch (const Notice& notice) {
  try {
    if (processes.is_first()) print(notice.text);
  } catch (const ClosedPipe&) {
    return closed_pipe_code;  // as a filter
  }
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
    std::fputs(
        formatted("Try 'eses-blocks {}{}--help'.\n", command.name, command.name.empty() ? "" : " ")
            .c_str(),
        stderr);
    return exit_usage;
  } catch (const StrictError& error) {
    for (const std::string& line : error.lines) print_message("error", line);
    return exit_failure;
  } catch (const SharedError& error) {
    if (processes.is_first()) print_message("error", message_of(error));
    return command.failure_code;
  } catch (const ClosedPipe& error) {
    return command.only_prints ? closed_pipe_code : fail(error.what());
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
    keep_free_memory();
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
  const Command* command = argc > 0 ? linked_command(argv[0]) : nullptr;
  if (command == nullptr && argc > 1) {
    command = named_command(argv[1]);
    if (command != nullptr) {
      --argc;
      ++argv;
    }
  }
  if (command == nullptr) command = &surface_command;
  try {
    return perform(*command, argc, argv);
  } catch (const std::bad_alloc&) {
    print_out_of_memory();
    return command->failure_code;
  }
}

}  // namespace eses::detail::cli
