#pragma once
/// Calls to the caller's check in long loops.

#include <cstdint>

#include "eses/check.hpp"

namespace eses::detail {

/// Calls the caller's check at every 4096th call of count().
class Checker {
 public:
  explicit Checker(const CheckCallback& check) : check_(check) {}

  void count() {
    constexpr std::uint32_t counts_between_checks = 1 << 12;
    if (++counts_ % counts_between_checks == 0) check();
  }

  void check() const {
    if (check_) check_();
  }

 private:
  const CheckCallback& check_;
  std::uint32_t counts_ = 0;
};

}  // namespace eses::detail
