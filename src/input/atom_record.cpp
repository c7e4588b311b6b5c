#include "input/atom_record.hpp"

#include <cmath>
#include <system_error>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

Fault fault_of(std::errc error) {
  if (error == std::errc{}) return Fault::none;
  return error == std::errc::result_out_of_range ? Fault::out_of_range : Fault::not_a_number;
}

Fault check_value(double value, const AtomQuantity& quantity) {
  if (!std::isfinite(value)) return Fault::not_finite;
  if (quantity.lowest == 0 && value < 0) return Fault::negative;
  return value < quantity.lowest || value > quantity.highest ? Fault::too_large : Fault::none;
}

std::string reason(const Problem& problem) {
  const std::string text = quoted(problem.text);
  switch (problem.fault) {
    case Fault::missing:
      return "missing";
    case Fault::not_a_number:
      return "expected a number, found " + text;
    case Fault::not_finite:
      return "expected a finite number, found " + text;
    case Fault::out_of_range:
      return text + " is out of the range of double precision";
    case Fault::negative:
      return "must not be negative, found " + text;
    case Fault::too_large:
      return formatted("{} is beyond the limit of {:.0f} angstrom", text, max_coordinate);
    case Fault::residue_number:
      return text + " seems to be the residue number; expected x y z charge radius at the end";
    case Fault::none:
    case Fault::too_few_fields:
    case Fault::extra_number:
      break;
  }
  return {};
}

}  // namespace

Problem read_value(std::string_view text, const AtomQuantity& quantity, double& value) {
  Fault fault = text.empty() ? Fault::missing : fault_of(parse_number(text, value));
  if (fault == Fault::none) fault = check_value(value, quantity);
  return {fault, quantity.name, text};
}

std::size_t count_fields(std::string_view text) {
  std::size_t count = 0;
  while (!take_first(text).empty()) ++count;
  return count;
}

std::string describe_field(const Problem& problem, std::string_view line) {
  const auto start = static_cast<std::size_t>(problem.text.data() - line.data());
  return formatted("field {} ({}): {}", count_fields(line.substr(0, start)) + 1, problem.quantity,
                   reason(problem));
}

}  // namespace eses::detail
