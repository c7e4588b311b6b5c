#pragma once
/// Reports of `eses-blocks diff`.

#include <string>

#include "cli/diff_options.hpp"
#include "diff/differences.hpp"

namespace eses::detail::cli {

/// Returns the text report: the differences of each file, and the overall result in the last line.
std::string diff_text(const DiffOptions& options, const Differences& found);

/// Returns the report as one JSON object.
std::string diff_json_text(const DiffOptions& options, const Differences& found);

}  // namespace eses::detail::cli
