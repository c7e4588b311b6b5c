#pragma once
/// The command `eses-blocks measure`.

#include "cli/measure_options.hpp"

namespace eses::detail::cli {

/// Measures the files, prints the results in the order of the files, and writes the tables. Prints
/// the errors of files that cannot be measured. Returns the exit code.
int measure_files(const MeasureCommandOptions& options);

}  // namespace eses::detail::cli
