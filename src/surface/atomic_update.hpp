#pragma once
/// Atomic minima and maxima.

#include "system/relaxed_reference.hpp"

namespace eses::detail {

/// Replaces `bound` by `value` if `is_before(value, bound)`. Several threads may update the same
/// bound at the same time.
template <class Value, class Before>
void atomic_update(Value& bound, Value value, Before is_before) {
  const RelaxedReference<Value> shared(bound);
  Value seen = shared.load();
  while (is_before(value, seen) && !shared.try_replace(seen, value)) {
  }
}

}  // namespace eses::detail
