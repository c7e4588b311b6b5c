#include "background.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "interrupts.hpp"

namespace eses::python {
namespace {

// Ends an action whose results nobody wants any more.
struct Stopped {};

constexpr std::chrono::milliseconds time_between_checks{50};

// The state that the caller shares with the thread.
struct Call {
  std::mutex mutex;
  std::condition_variable changed;
  bool is_stopped = false, has_ended = false;
  std::exception_ptr failure;

  void check() {
    const std::lock_guard lock(mutex);
    if (is_stopped) throw Stopped();
  }

  void run(const std::function<void(const CheckCallback&)>& action) {
    std::exception_ptr caught;
    try {
      action([this] { check(); });
    } catch (...) {
      caught = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    failure = std::move(caught);
    has_ended = true;
    changed.notify_all();
  }

  bool wait() {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, time_between_checks, [this] { return has_ended; });
  }

  void stop() {
    const std::lock_guard lock(mutex);
    is_stopped = true;
  }
};

struct ThreadLeftBehind {
  std::thread thread;
  pid_t process;  // that has the thread: a forked one does not
};

std::mutex left_behind_mutex;
std::vector<ThreadLeftBehind> left_behind;

}  // namespace

void call_in_background(std::function<void(const CheckCallback&)> action) {
  const auto call = std::make_shared<Call>();
  std::thread thread([call, action = std::move(action)] { call->run(action); });
  Interrupts interrupts;
  try {
    while (!call->wait()) interrupts.check();
  } catch (...) {
    call->stop();
    const std::lock_guard lock(left_behind_mutex);
    left_behind.push_back({std::move(thread), getpid()});
    throw;
  }
  thread.join();
  if (call->failure) std::rethrow_exception(call->failure);
}

void join_threads_left_behind() {
  const std::lock_guard lock(left_behind_mutex);
  for (auto& [thread, process] : left_behind) {
    if (process == getpid())
      thread.join();
    else
      thread.detach();
  }
  left_behind.clear();
}

}  // namespace eses::python
