#pragma once
/// Checks of the arguments of public functions.

#include <stdexcept>
#include <utility>

#include "eses/error.hpp"

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

}  // namespace eses::detail
