#include "cli/interruption.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <utility>

namespace eses::cli {
namespace {

constexpr unsigned grace = 1;  // seconds that a run has to end in order

// All that a signal handler can see is global, and all that it may use is lock-free.
std::atomic<int> received_signal = 0;
std::atomic<const InterruptibleRun*> current_run = nullptr;
std::atomic<bool> is_ending = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
              std::atomic<const InterruptibleRun*>::is_always_lock_free);

[[noreturn]] void end_now(int /*signal*/) {
  is_ending = true;
  if (const InterruptibleRun* const run = current_run) run->remove_leftovers();
  _exit(128 + received_signal);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

void take_signal(int signal) {
  int none = 0;
  const bool is_first = received_signal.compare_exchange_strong(none, signal);
  if (!is_first || current_run == nullptr) end_now(signal);
  handle(SIGALRM, end_now);
  alarm(grace);
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void end_on_signals() {
  handle(SIGINT, take_signal);
  handle(SIGTERM, take_signal);
  if (!is_ignored(SIGHUP)) handle(SIGHUP, take_signal);
}

InterruptibleRun::InterruptibleRun(std::vector<std::string> temporaries,
                                   std::vector<std::string> locks)
    : temporaries_(std::move(temporaries)), locks_(std::move(locks)) {
  current_run = this;
}

InterruptibleRun::~InterruptibleRun() {
  current_run = nullptr;
  // A handler in another thread may be using this; then the process is about to end.
  while (is_ending) pause();
}

void InterruptibleRun::check() {
  has_locks_ = true;
  if (received_signal != 0) throw Interrupted{128 + received_signal};
}

void InterruptibleRun::remove_leftovers() const {
  for (const std::string& path : temporaries_) unlink(path.c_str());
  if (!has_locks_) return;
  for (const std::string& path : locks_) unlink(path.c_str());
}

}  // namespace eses::cli
