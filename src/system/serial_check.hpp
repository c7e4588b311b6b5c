#pragma once
/// A check callback that several threads share.

#include <mutex>

#include "eses/check.hpp"

namespace eses::detail {

/// Calls a CheckCallback, if it is not empty, from one thread at a time.
class SerialCheck {
 public:
  /// Keeps a reference to `check`.
  explicit SerialCheck(const CheckCallback& check) : check_(check) {}

  /// Calls the callback. An exception that it throws is thrown on.
  void operator()() {
    if (!check_) return;
    const std::lock_guard lock(mutex_);
    check_();
  }

 private:
  const CheckCallback& check_;
  std::mutex mutex_;
};

}  // namespace eses::detail
