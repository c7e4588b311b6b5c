#pragma once
/// Options of the surface command that depend on each other.

#include "cli/options.hpp"

namespace CLI {
class App;
}

namespace eses::detail::cli {

/// Checks values that depend on each other, and sets those of outputs. Removes outputs that are not
/// chosen. Throws UsageError.
void choose_values(const CLI::App& app, Options& options);

}  // namespace eses::detail::cli
