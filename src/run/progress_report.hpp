#pragma once
/// How far a run is, told from any thread.

#include <cstdint>
#include <mutex>

#include "eses/run.hpp"

namespace eses {

/// Calls the callback, if there is one, from one thread at a time. What that throws ends the run.
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

 private:
  const ProgressCallback& callback_;
  std::mutex mutex_;
  std::int64_t blocks_, solved_blocks_ = 0;
};

}  // namespace eses
