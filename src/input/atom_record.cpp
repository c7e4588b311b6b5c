#include "input/atom_record.hpp"

#include <cmath>
#include <system_error>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

namespace {

/// Returns the pattern of the message for a value that is refused.
std::string_view fault_of(double value, std::errc error, const AtomQuantity& quantity) {
  if (error == std::errc::result_out_of_range) return "{} is out of the range of double precision";
  if (error != std::errc{}) return not_a_number;
  if (!std::isfinite(value)) return "expected a finite number, found {}";
  if (quantity.lowest == 0 && value < 0) return "must not be negative, found {}";
  return "{} is beyond the limit of {:.0f} angstrom";
}

}  // namespace

Problem read_value(std::string_view text, const AtomQuantity& quantity, double& value) {
  if (text.empty()) return {"missing", quantity.name, text};
  const std::errc error = parse_number(text, value);
  // Comparisons with NaN are false.
  if (error == std::errc{} && value >= quantity.lowest && value <= quantity.highest) return {};
  return {fault_of(value, error, quantity), quantity.name, text};
}

std::string describe(const Problem& problem, std::string_view line) {
  const std::string cause =
      formatted(fmt::runtime(problem.pattern), quoted(problem.text), max_coordinate);
  if (problem.quantity.empty()) return cause;
  const auto start = static_cast<std::size_t>(problem.text.data() - line.data());
  return formatted("field {} ({}): {}", count_fields(line.substr(0, start)) + 1, problem.quantity,
                   cause);
}

}  // namespace eses::detail
