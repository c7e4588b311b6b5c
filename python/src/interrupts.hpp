#pragma once
/// Handles signals such as SIGINT during computations that have released the interpreter's lock.

#include <chrono>
#include <thread>

namespace eses::python {

/// Runs Python's signal handlers from time to time. Python handles signals in its main thread only,
/// so an object acts only in the thread that made it.
class Interrupts {
 public:
  /// Runs the signal handlers of Python if the last time was a while ago. Does nothing in other
  /// threads than the one that made the object. Must be called without the interpreter's lock.
  /// Throws pybind11::error_already_set if a handler raises an exception, as the handler of SIGINT
  /// does.
  void check();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds interval{50};
  std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point next_ = Clock::now() + interval;
};

}  // namespace eses::python
