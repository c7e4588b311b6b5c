#pragma once
/// Checks of the arguments of public functions.

#include <stdexcept>
#include <utility>

#include "eses/error.hpp"
#include "eses/measure.hpp"

namespace eses::detail {

/// Calls `check`, which depends on the caller's arguments only, and returns its result. Converts
/// Error to std::invalid_argument.
template <class Check>
decltype(auto) check_arguments(Check&& check) {
  try {
    return std::forward<Check>(check)();
  } catch (const Error& error) {
    throw std::invalid_argument(error.what());
  }
}

/// Throws std::invalid_argument if the probe radius or the number of threads is out of its range.
void require_valid(const MeasureOptions& options);

}  // namespace eses::detail
