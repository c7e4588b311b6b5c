#include "input/pqr_labels.hpp"

#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

/// Returns whether a field consists of a chain letter and a residue number, such as `A1000` or
/// `A-12B`.
bool holds_chain(std::string_view number) {
  if (number.size() < 2 || number[0] == '-' || is_digit(number[0])) return false;
  return is_digit(number[1]) || (number.size() > 2 && number[1] == '-' && is_digit(number[2]));
}

}  // namespace

AtomLabel label_of_fields(std::string_view leading) {
  const std::string_view record = take_first(leading);
  if (!is_digit(record.back())) take_first(leading);
  AtomLabel label;
  label.atom_name = take_first(leading);
  label.residue = take_first(leading);
  std::string_view number = take_last(leading);
  std::string_view chain = take_first(leading);
  if (chain.empty() && holds_chain(number)) {
    chain = number.substr(0, 1);
    number.remove_prefix(1);
  }
  label.chain = chain;
  label.residue_number = number;
  return label;
}

AtomLabel label_of_columns(std::string_view line) {
  // Column 20 is blank in the PDB format, but may hold the fourth character of a residue name.
  AtomLabel label;
  label.atom_name = column_text(line, 12, 4);
  label.residue = column_text(line, 17, 4);
  label.chain = column_text(line, 21, 1);
  label.residue_number = column_text(line, 22, 5);
  return label;
}

}  // namespace eses::detail
