#pragma once
/// Calls to the caller's check while gemmi parses a text.

#include <cstdint>
#include <exception>

#include "eses/check.hpp"

namespace eses::detail {

/// Carries an exception of the caller's check through gemmi. Handlers that convert exceptions to
/// Error do not catch it.
struct Interruption {
  std::exception_ptr cause;
};

/// Calls the caller's check at every 4096th call of count().
class Checker {
 public:
  explicit Checker(const CheckCallback& check) : check_(check) {}

  void count() {
    constexpr std::uint32_t counts_between_checks = 1 << 12;
    if (++counts_ % counts_between_checks == 0) check();
  }

  void check() const {
    if (!check_) return;
    try {
      check_();
    } catch (...) {
      throw Interruption{std::current_exception()};
    }
  }

 private:
  const CheckCallback& check_;
  std::uint32_t counts_ = 0;
};

}  // namespace eses::detail
