#pragma once
/// Calls to the caller's check in long loops.

#include <cstdint>

#include "eses/check.hpp"

namespace eses::detail {

/// Calls `check` at every 4096th count, if it is not empty.
inline void check_at(std::uint64_t count, const CheckCallback& check) {
  constexpr std::uint64_t counts_between_checks = 1 << 12;
  if (count % counts_between_checks == 0 && check) check();
}

}  // namespace eses::detail
