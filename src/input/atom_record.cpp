#include "input/atom_record.hpp"

#include <cmath>
#include <system_error>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

Problem read_value(std::string_view text, const AtomQuantity& quantity, double& value) {
  const auto problem = [&](std::string_view pattern) {
    return Problem{pattern, quantity.name, text};
  };
  if (text.empty()) return problem("missing");
  const std::errc error = parse_number(text, value);
  if (error == std::errc::result_out_of_range)
    return problem("{} is out of the range of double precision");
  if (error != std::errc{}) return problem(not_a_number);
  if (!std::isfinite(value)) return problem("expected a finite number, found {}");
  if (quantity.lowest == 0 && value < 0) return problem("must not be negative, found {}");
  if (value < quantity.lowest || value > quantity.highest)
    return problem("{} is beyond the limit of {:.0f} angstrom");
  return {};
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
