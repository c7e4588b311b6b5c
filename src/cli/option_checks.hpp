#pragma once
/// Options of the surface command that depend on each other.

#include "cli/options.hpp"

namespace CLI {
class App;
}

namespace eses::detail::cli {

/// Checks values that depend on each other, and sets the outputs of the request. Throws UsageError.
void choose_values(const CLI::App& app, OutputChoice choice, Options& options);

}  // namespace eses::detail::cli
