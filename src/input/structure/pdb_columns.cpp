#include "input/structure/pdb_columns.hpp"

#include <algorithm>
#include <string>

#include "input/atom_records.hpp"
#include "input/pdb_elements.hpp"
#include "input/structure/structure_atoms.hpp"

namespace eses::detail {
namespace {

/// Returns whether the element, which has no columns of its own, agrees with the name of the atom.
bool agrees_with_name(std::string_view symbol, std::string_view record) {
  std::string_view name = field_of(record, name_columns);
  while (!name.empty() && !is_letter(name.front())) name.remove_prefix(1);
  return name.size() >= symbol.size() &&
         starts_with_ignoring_case(name, lower_case(std::string(symbol)));
}

/// Returns whether a symbol beside the columns of the element is the element of the atom. The name
/// need not agree with it, unless another reading is likelier: names in amino acids and nucleotides
/// tell their elements, and `letter` may be the element, beside a segment or a type of the atom.
bool is_shifted_element(std::string_view symbol, std::string_view letter, std::string_view record) {
  const std::string usual = usual_spelling(symbol);
  if (usual.empty()) return false;
  if (agrees_with_name(symbol, record)) return true;
  if (is_polymer_residue(field_of(record, residue_columns))) return false;
  return symbol == usual || usual_spelling(letter).empty() || !agrees_with_name(letter, record);
}

bool is_letter_at(std::string_view record, std::size_t i) {
  return i < record.size() && is_letter(record[i]);
}

/// Returns the symbol that begins one column before those of the element; empty if there is none.
std::string_view element_on_the_left(std::string_view record) {
  constexpr std::size_t first = element_columns.first;
  if (!is_letter_at(record, first - 1) || !is_letter_at(record, first) ||
      is_letter_at(record, first + 1))
    return {};
  const std::string_view symbol = record.substr(first - 1, 2);
  const bool is_segment = !trimmed(record.substr(segment_columns.first, 3)).empty();
  return !is_segment && is_shifted_element(symbol, symbol.substr(1), record) ? symbol
                                                                             : std::string_view();
}

}  // namespace

std::string_view element_of_columns(std::string_view record) {
  if (is_pdbqt_record(record)) return {};
  const auto text = [&](std::size_t first, std::size_t width) {
    return first < record.size() ? record.substr(first, width) : std::string_view();
  };
  constexpr std::size_t first = element_columns.first;
  const std::string_view right = text(first + 1, 2);
  if (const std::string_view left = element_on_the_left(record); !left.empty()) return left;
  if (!is_letter_at(record, first) && is_letter_at(record, first + 1) &&
      is_letter_at(record, first + 2) && is_shifted_element(right, right.substr(0, 1), record))
    return right;
  const std::string_view field = field_of(record, element_columns);
  if (record.size() > first + 1 && std::any_of(field.begin(), field.end(), is_letter)) return field;
  const std::string_view last = trimmed(text(first + 2, 2)).substr(0, 2);
  const bool is_one = last.size() == 1 || (last.size() == 2 && !is_letter(last[1]));
  const std::string_view symbol = last.substr(0, is_one ? 1 : 2);
  if (!field.empty() || !is_shifted_element(symbol, symbol.substr(0, 1), record)) return {};
  // Names such as CL1 say more than the first letter of the element.
  const std::string_view residue = field_of(record, residue_columns);
  if (is_one && element_by_name({column_text(record, name_columns.first, name_columns.width),
                                 residue, is_polymer_residue(residue)})
                        .size() > 1)
    return {};
  return symbol;
}

std::string_view element_in_segment(std::string_view record) {
  const std::string_view field = field_of(record, segment_columns);
  const bool is_alone = column_text(record, 66, 6).empty() && column_text(record, 76, 4).empty();
  const bool is_element = is_alone && field.size() <= 2 && !usual_spelling(field).empty();
  return is_element && agrees_with_name(field, record) ? field : std::string_view();
}

std::string_view segment_of(std::string_view record) {
  const std::string_view segment = field_of(record, segment_columns);
  if (segment.empty()) return segment;
  const std::string_view last = column_text(record, segment_columns.first + 4, 4);
  const bool has_line_number = !last.empty() && std::all_of(last.begin(), last.end(), is_digit);
  const bool follows_blanks = column_text(record, 66, segment_columns.first - 66).empty();
  const bool is_segment = !has_line_number && follows_blanks && !is_pdbqt_record(record) &&
                          element_on_the_left(record).empty();
  return is_segment ? segment : std::string_view();
}

}  // namespace eses::detail
