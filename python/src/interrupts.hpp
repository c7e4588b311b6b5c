#pragma once
/// Signals such as that of Ctrl-C during computations that do not hold the interpreter's lock.

#include <chrono>
#include <thread>

namespace eses::python {

/// Lets Python handle its signals from time to time. It belongs to the thread that makes it: Python
/// handles signals in its main thread alone.
class Interrupts {
 public:
  /// Runs the signal handlers of Python if the last time was a while ago and if the caller is the
  /// thread that made the object; does nothing otherwise. Must be called without the interpreter's
  /// lock. Throws pybind11::error_already_set if a handler raises an exception, as that of SIGINT
  /// does.
  void check();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds interval{50};
  std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point next_ = Clock::now() + interval;
};

}  // namespace eses::python
