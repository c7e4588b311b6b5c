#pragma once
/// Options of the surface command that depend on each other.

#include <optional>

#include "cli/options.hpp"

namespace CLI {
class App;
}

namespace eses::detail::cli {

/// A parameter that can be given as a positional argument or as an option.
struct Length {
  std::optional<double> positional, option;

  bool is_given() const { return positional || option; }
};

/// The lengths of the command line.
struct Lengths {
  Length probe_radius, spacing, margin;
};

/// Checks values that depend on each other, and sets those of lengths and outputs. Removes outputs
/// that are not chosen. Throws UsageError.
void choose_values(const CLI::App& app, const Lengths& lengths, Options& options);

}  // namespace eses::detail::cli
