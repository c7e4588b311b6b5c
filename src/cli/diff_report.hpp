#pragma once
/// What `eses-blocks diff` tells.

#include <string>

#include "cli/diff_options.hpp"
#include "diff/differences.hpp"

namespace eses::detail::cli {

/// File by file, and the verdict on the last line.
std::string diff_text(const DiffOptions& options, const Differences& found);

/// The same as one JSON object.
std::string diff_json_text(const DiffOptions& options, const Differences& found);

}  // namespace eses::detail::cli
