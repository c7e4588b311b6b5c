#include "cli/filling_report.hpp"

#include <cmath>

#include "system/formatted.hpp"

namespace eses::detail::cli {

std::string filling_text(std::span<const FilledCavity> filled) {
  if (filled.empty()) return "filled cavities: none\n";
  return formatted("filled cavities: {}, with voids from {:.6g} to {:.6g} cubic angstrom\n",
                   filled.size(), filled.back().void_volume, filled.front().void_volume);
}

json::Value filled_json(std::optional<double> max_filled_void,
                        std::span<const FilledCavity> filled) {
  if (!max_filled_void) return {};
  return json::array_of(filled, [](const FilledCavity& cavity) -> json::Value {
    return {{"id", cavity.id}, {"void_volume", cavity.void_volume}};
  });
}

json::Value fill_choice_json(std::optional<double> max_filled_void) {
  if (!max_filled_void) return {};
  return std::isinf(*max_filled_void) ? json::Value("all") : json::Value(*max_filled_void);
}

}  // namespace eses::detail::cli
