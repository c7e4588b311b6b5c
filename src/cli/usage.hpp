#pragma once
/// Exceptions of parsing a command line.

#include <stdexcept>
#include <string>

namespace eses::detail::cli {

/// The text of `--help` or `--version`, which is printed instead of starting a command.
struct Notice {
  std::string text;
};

/// An error in the command line. `what()` names the option, its value and the expected value.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace eses::detail::cli
