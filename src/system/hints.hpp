#pragma once
/// Errors that another choice of the caller avoids.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "eses/error.hpp"

namespace eses::detail {

/// A base of errors that another choice of the caller avoids. A hint is the name of a parameter,
/// perhaps with a value for it, such as `max_memory 20M`. The command line adds hints to the
/// message, as options.
class Hints {
 public:
  explicit Hints(std::vector<std::string> hints) : hints_(std::move(hints)) {}
  const std::vector<std::string>& hints() const { return hints_; }

 private:
  std::vector<std::string> hints_;
};

/// An error with hints.
class HintedError : public Error, public Hints {
 public:
  explicit HintedError(const std::string& message, std::vector<std::string> hints = {})
      : Error(message), Hints(std::move(hints)) {}
};

/// An argument out of its range, with the parameters that change it as hints.
class HintedArgument : public std::invalid_argument, public Hints {
 public:
  HintedArgument(const std::string& message, std::vector<std::string> hints)
      : std::invalid_argument(message), Hints(std::move(hints)) {}
};

/// A grid needs more memory than there is.
class GridTooLarge : public MemoryLimitError, public Hints {
 public:
  /// `need` states the required and the available memory, `advice` the options to change.
  GridTooLarge(const std::string& need, const std::string& advice,
               std::vector<std::string> hints = {})
      : MemoryLimitError(need + "; " + advice), Hints(std::move(hints)), need_(need) {}
  const std::string& need() const { return need_; }

 private:
  std::string need_;
};

/// The memory limit of the caller does not suffice.
class LimitExceeded : public MemoryLimitError, public Hints {
 public:
  /// `limit` is a limit that suffices, such as `20M`, or empty if it is unknown.
  explicit LimitExceeded(const std::string& message, const std::string& limit = "")
      : MemoryLimitError(message), Hints({limit.empty() ? "max_memory" : "max_memory " + limit}) {}
};

}  // namespace eses::detail
