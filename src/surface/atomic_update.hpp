#pragma once
/// Atomic minima and maxima.

#include <atomic>

namespace eses::detail {

/// Replaces `bound` by `value` if `is_before(value, bound)`. Several threads may update the same
/// bound at the same time.
template <class Value, class Before>
void atomic_update(Value& bound, Value value, Before is_before) {
  const std::atomic_ref<Value> shared(bound);
  Value seen = shared.load(std::memory_order_relaxed);
  while (is_before(value, seen) &&
         !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

}  // namespace eses::detail
