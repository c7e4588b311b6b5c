#pragma once
/// What a command line may amount to besides something to do.

#include <stdexcept>
#include <string>

namespace eses::detail::cli {

/// A text to print in place of a run: `--help` or `--version`.
struct Notice {
  std::string text;
};

/// A command line that asks for nothing sensible; `what()` names option, value and expectation.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace eses::detail::cli
