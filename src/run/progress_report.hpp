#pragma once
/// Progress of a run, and serialization of its callbacks.

#include <cstdint>
#include <mutex>

#include "run/request.hpp"

namespace eses::detail {

/// Calls the progress callback, if it is not empty, and other callbacks of the run, one at a time.
/// An exception of a callback ends the run.
class ProgressReport {
 public:
  /// Keeps a reference to `callback`.
  ProgressReport(const ProgressCallback& callback, std::int64_t blocks)
      : callback_(callback), blocks_(blocks) {}

  /// Adds solved blocks and calls the callback.
  void add(std::int64_t solved_blocks) {
    if (!callback_) return;
    const std::lock_guard lock(mutex_);
    solved_blocks_ += solved_blocks;
    callback_(solved_blocks_, blocks_);
  }
  /// Calls the callback without progress, so that it can end the run by an exception.
  void check() { add(0); }

  /// Calls `other_callback` while no other callback of the run is being called.
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
