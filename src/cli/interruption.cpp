#include "cli/interruption.hpp"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace eses::detail::cli {
namespace {

constexpr unsigned grace = 1;                // seconds that a run has for an orderly end
constexpr timespec settling{0, 20'000'000};  // time in which all threads ask whether a run goes on

// Signals that cannot be handled, and signals whose default action does not end the process.
constexpr std::array not_ending{
    SIGKILL, SIGSTOP, SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT, SIGCHLD, SIGURG, SIGWINCH,
#ifdef SIGINFO  // macOS and BSD
    SIGINFO, SIGIO,
#endif
};
// Signals whose default action is a core dump, except SIGXCPU, which is a time limit.
constexpr std::array crashes{SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP};

// Signal handlers can use only global variables, which must be lock-free.
std::atomic<int> received_signal = 0;
std::atomic<const InterruptibleRun*> current_run = nullptr;
std::atomic<bool> is_ending = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
              std::atomic<const InterruptibleRun*>::is_always_lock_free);

void remove_leftovers() {
  is_ending = true;
  if (const InterruptibleRun* const run = current_run) run->remove_leftovers();
}

[[noreturn]] void end_now(int /*signal*/) {
  remove_leftovers();
  _exit(128 + received_signal);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

// Removes the temporary files and locks, and then performs the default action, a core dump. Files
// that other threads create meanwhile are removed, too: threads stop where they ask whether the run
// goes on. The signal is blocked in its handler; if the handler itself causes it, the system ends
// the process.
void end_with_core_dump(int signal) {
  remove_leftovers();
  nanosleep(&settling, nullptr);
  remove_leftovers();
  handle(signal, SIG_DFL);
  raise(signal);
}

void take_signal(int signal) {
  int none = 0;
  const bool is_first = received_signal.compare_exchange_strong(none, signal);
  if (!is_first || current_run == nullptr) end_now(signal);
  handle(SIGALRM, end_now);
  alarm(grace);
}

// Returns whether a signal has its default action. Other signals are ignored on request of the
// parent process (nohup, `trap '' INT`, background jobs of a shell), or used by a library such as
// MPI, a profiler or a sanitizer.
bool has_default_action(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && (action.sa_flags & SA_SIGINFO) == 0 &&
         action.sa_handler == SIG_DFL;
}

}  // namespace

void end_on_signals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    if (std::ranges::count(not_ending, signal) > 0 || !has_default_action(signal)) continue;
    const bool is_crash = std::ranges::count(crashes, signal) > 0;
    handle(signal, is_crash ? end_with_core_dump : take_signal);
  }
}

InterruptibleRun::InterruptibleRun(OutputPaths paths) : paths_(std::move(paths)) {
  current_run = this;
}

InterruptibleRun::~InterruptibleRun() {
  current_run = nullptr;
  // A handler in another thread may be using this object. In that case the process is about to end.
  while (is_ending) pause();
}

void InterruptibleRun::check() {
  while (is_ending) pause();
  if (received_signal != 0) throw Interrupted{128 + received_signal};
}

void InterruptibleRun::remove_leftovers() const {
  for (const std::string& path : paths_.temporaries) unlink(path.c_str());
  if (!has_locks_) return;
  for (const std::string& path : paths_.locks) unlink(path.c_str());
}

}  // namespace eses::detail::cli
