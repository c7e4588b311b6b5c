#pragma once
/// Reports of filled cavities.

#include <optional>
#include <span>
#include <string>

#include "cli/json.hpp"
#include "eses/cavities.hpp"

namespace eses::detail::cli {

/// Returns the line of the text report.
std::string filling_text(std::span<const FilledCavity> filled);

/// Returns a list with the number and the void of each filled cavity, or null without
/// `max_filled_void`.
json::Value filled_json(std::optional<double> max_filled_void,
                        std::span<const FilledCavity> filled);

/// Returns the value of --fill-cavities: null, "all", or a volume.
json::Value fill_choice_json(std::optional<double> max_filled_void);

}  // namespace eses::detail::cli
