#pragma once
/// Bounds that threads move at the same time.

#include <atomic>

namespace eses::detail {

/// Replaces the bound by the value if that comes before it.
template <class Value, class Before>
void atomic_update(Value& bound, Value value, Before is_before) {
  const std::atomic_ref<Value> shared(bound);
  Value seen = shared.load(std::memory_order_relaxed);
  while (is_before(value, seen) &&
         !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

}  // namespace eses::detail
