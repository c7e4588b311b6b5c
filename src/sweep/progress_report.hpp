#pragma once
/// How far a run is, told from any thread, and the lock that keeps callbacks apart.

#include <cstdint>
#include <mutex>

#include "task/task.hpp"

namespace eses::detail {

/// Calls the progress callback, if there is one, and other callbacks of the run, one at a time. An
/// exception that one of them throws ends the run.
class ProgressReport {
 public:
  /// Keeps a reference to `callback`.
  ProgressReport(const ProgressCallback& callback, std::int64_t blocks)
      : callback_(callback), blocks_(blocks) {}

  void add(std::int64_t solved_blocks) {
    if (!callback_) return;
    const std::lock_guard lock(mutex_);
    solved_blocks_ += solved_blocks;
    callback_(solved_blocks_, blocks_);
  }
  /// Says nothing new, but lets the callback end the run.
  void check() { add(0); }

  /// Calls `other_callback` while no callback of the run is being called.
  template <class Callback>
  void call(Callback&& other_callback) {
    const std::lock_guard lock(mutex_);
    other_callback();
  }

 private:
  const ProgressCallback& callback_;
  std::mutex mutex_;
  std::int64_t blocks_, solved_blocks_ = 0;
};

}  // namespace eses::detail
