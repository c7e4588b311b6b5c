#pragma once
/// Measurement of wall-clock time.

#include <chrono>

namespace eses::detail {

/// A clock that starts when it is constructed.
class Stopwatch {
 public:
  /// Returns the time since construction in seconds.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace eses::detail
