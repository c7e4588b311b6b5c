#pragma once
/// Waits of threads for the work of other threads.

#include <condition_variable>
#include <mutex>

namespace eses::detail {

/// State that threads change and wait for, one at a time.
class Monitor {
 public:
  /// Thrown by waits that `stop` has ended.
  struct Stopped {};

  /// Changes the state, and lets waiting threads check their conditions again.
  template <class Action>
  void change(Action&& action) {
    {
      const std::lock_guard lock(mutex_);
      action();
    }
    changed_.notify_all();
  }
  /// Waits until `try_take()` returns a value, and returns it. Returns nothing if `is_over()`.
  /// `try_take` may change the state, so that no other thread takes the same.
  template <class TryTake, class IsOver>
  auto take(TryTake&& try_take, IsOver&& is_over) {
    decltype(try_take()) taken;
    wait_until([&] { return (taken = try_take()) || is_over(); });
    return taken;
  }
  /// Waits until `condition()` returns true.
  template <class Condition>
  void wait_until(Condition&& condition) {
    std::unique_lock lock(mutex_);
    while (!is_stopped_ && !condition()) changed_.wait(lock);
    if (is_stopped_) throw Stopped();
  }
  /// Ends all waits, also later ones, after a failure.
  void stop() {
    change([this] { is_stopped_ = true; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_stopped_ = false;
};

}  // namespace eses::detail
