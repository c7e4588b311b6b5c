#pragma once
/// Checks of arguments.

#include <stdexcept>
#include <utility>

#include "eses/error.hpp"

namespace eses::detail {

/// Performs checks that depend on the caller's arguments alone, and returns their result. Throws
/// std::invalid_argument where they throw Error.
template <class Check>
decltype(auto) check_arguments(Check&& check) {
  try {
    return std::forward<Check>(check)();
  } catch (const Error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace eses::detail
