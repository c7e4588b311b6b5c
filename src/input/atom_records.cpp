#include "input/atom_records.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "input/other_formats.hpp"
#include "input/pdb_elements.hpp"
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

namespace {

// The free format is `ATOM serial name residue [chain] number x y z charge radius`, see
// https://apbs.readthedocs.io/en/latest/formats/pqr.html. Programs that use the columns of PDB
// files may write numbers without a blank between them, see
// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html. Some programs append
// an element symbol, as in PDB files. ESES and APBS ignore it.

constexpr std::array pqr_quantities{quantity_x, quantity_y, quantity_z, quantity_charge,
                                    quantity_radius};
constexpr std::string_view too_few_fields =
    "expected at least {} fields, the last five being x y z charge radius, found {}";
constexpr std::string_view extra_number =
    "more than five numbers, expected x y z charge radius; remove the fields after the radius";
constexpr std::string_view trailing_text =
    "text {} after the radius, expected x y z charge radius at the end; remove the text";
constexpr std::string_view likely_residue_number =
    "{} seems to be the residue number; expected x y z charge radius at the end";

using PqrFields = std::array<std::string_view, pqr_quantities.size()>;

constexpr std::size_t first_coordinate_column = 30;  // 0-based
constexpr std::size_t coordinate_width = 8;
constexpr std::size_t end_of_coordinates = first_coordinate_column + 3 * coordinate_width;
// Widths of charge and radius as pdb2pqr writes them, %8.4f and %7.4f.
constexpr std::size_t charge_width = 8, radius_width = 7;
constexpr std::size_t radius_column = end_of_coordinates + charge_width;
constexpr std::size_t end_of_radius = radius_column + radius_width;

// ----------------------------------------------------------------------------------------- names

/// Returns whether a field consists of a chain letter and a residue number, such as `A1000` or
/// `A-12B`.
bool holds_chain(std::string_view number) {
  if (number.size() < 2 || number[0] == '-' || is_digit(number[0])) return false;
  return is_digit(number[1]) || (number.size() > 2 && number[1] == '-' && is_digit(number[2]));
}

/// Returns the label of a record in free format. `leading` has the fields before the coordinates:
/// record name, serial number, atom name, residue name, chain (optional) and residue number. The
/// chain may be joined with the residue number, and the record name with the serial number.
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

/// Returns the label of a record in the columns of PDB files. The record must have at least 27
/// characters.
AtomLabel label_of_columns(std::string_view line) {
  const ResidueColumns columns = split_residue(line);
  AtomLabel label;
  label.atom_name = column_text(line, 12, 4);
  label.residue = columns.residue;
  label.chain = columns.chain;
  label.residue_number = column_text(line, 22, 5);
  return label;
}

/// Returns whether serial number and residue number fill their columns, and blanks separate the
/// other ones. The record must have the columns of coordinates.
bool has_label_columns(std::string_view line) {
  std::string_view number = column_text(line, 22, 4), serial = column_text(line, 6, 5);
  if (number.starts_with('-')) number.remove_prefix(1);
  const auto is_number = [](std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
  };
  return is_number(serial) && is_number(number) && is_blank(line[11]) &&
         column_text(line, 27, 3).empty() && !column_text(line, 12, 4).empty() &&
         !column_text(line, 17, 4).empty();
}

// ---------------------------------------------------------------------------------------- values

Problem read_pqr_values(const PqrFields& fields, Record& record) {
  std::array<double, pqr_quantities.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (Problem problem = read_value(fields[i], pqr_quantities[i], values[i])) return problem;
  }
  record.atom = {{values[0], values[1], values[2]}, values[4]};
  record.charge = values[3];
  return {};
}

/// Returns the number of fields before the coordinates without a chain: record, serial number, atom
/// name, residue name and residue number.
std::size_t min_leading_fields(std::string_view line) {
  std::string_view rest = line;
  const std::string_view record = take_first(rest);
  const bool holds_serial = !record.empty() && is_digit(record.back());
  return holds_serial ? 4 : 5;
}

/// Returns whether x seems to be the residue number, because charge or radius is missing. Fields
/// are counted from the end of the line, so the record would otherwise be read with wrong values.
bool looks_like_residue_number(std::string_view x, std::string_view leading) {
  const bool is_integer =
      std::all_of(x.begin(), x.end(), [](char c) { return c == '-' || is_digit(c); });
  const std::string_view before = take_last(leading);
  return is_integer && std::none_of(before.begin(), before.end(), is_digit);
}

/// Returns whether a field is a number with a decimal point. Names and residue numbers are not.
bool is_decimal(std::string_view field) {
  double value = 0;
  return field.find('.') != std::string_view::npos && parse_number(field, value) == std::errc{};
}

/// Returns whether a further number comes before the last five, which are not part of `leading`.
/// Such a record is ambiguous: ESES reads the last two numbers as charge and radius, APBS the
/// fourth and fifth.
/// A number without a decimal point is one more if a residue number precedes it.
bool has_extra_number(std::string_view leading) {
  constexpr std::size_t max_leading_fields = 6;  // record, serial, atom, residue, chain, number
  const bool has_more = count_fields(leading) > max_leading_fields;
  const std::string_view last = take_last(leading);
  if (is_decimal(last)) return true;
  int value = 0;
  return has_more && parse_integer(last, value) && parse_integer(take_last(leading), value);
}

Problem parse_pqr_fields(std::string_view line, Record& record) {
  PqrFields fields;
  std::string_view leading = line;
  for (std::size_t i = fields.size(); i-- > 0;) fields[i] = take_last(leading);
  if (count_fields(leading) < min_leading_fields(line)) return {too_few_fields, {}, line};
  const Problem problem = read_pqr_values(fields, record);
  if (!problem && has_extra_number(leading)) return {extra_number, {}, fields.back()};
  // If two errors apply, the one about text that is not a number is clearer.
  if (problem.pattern != not_a_number && looks_like_residue_number(fields[0], leading)) {
    return {likely_residue_number, quantity_x.name, fields[0]};
  }
  if (!problem) record.label = label_of_fields(leading);
  return problem;
}

std::string_view coordinate_column(std::string_view line, std::size_t axis) {
  const std::size_t start = first_coordinate_column + axis * coordinate_width;
  return without_leading_blanks(line.substr(start, coordinate_width));
}

/// Returns whether a column holds a number. A decimal point and a digit at the end are required, so
/// that columns never split one number of the free format into two.
bool is_column_number(std::string_view text) {
  return !text.empty() && is_digit(text.back()) && is_decimal(text);
}

/// Returns whether the columns of x, y and z hold numbers.
bool holds_coordinates(std::string_view line) {
  return line.size() >= end_of_coordinates && is_column_number(coordinate_column(line, 0)) &&
         is_column_number(coordinate_column(line, 1)) &&
         is_column_number(coordinate_column(line, 2));
}

/// Returns whether x, y and z are in their columns, and separate from the fields around them.
bool has_coordinate_columns(std::string_view line) {
  if (!holds_coordinates(line) || !is_blank(line[first_coordinate_column - 1])) return false;
  const std::string_view rest = line.substr(end_of_coordinates);
  return rest.empty() || is_blank(rest[0]) || rest[0] == '-' || rest[0] == '+';
}

bool ends_at(std::string_view line, std::size_t column) {
  return line.size() == column || (line.size() > column && is_blank(line[column]));
}

/// Returns whether charge and radius fill their columns without a blank between them.
bool has_joined_charge_and_radius(std::string_view line) {
  if (line.size() < end_of_radius || !ends_at(line, end_of_radius)) return false;
  const std::string_view radius = line.substr(radius_column, radius_width);
  return is_column_number(without_leading_blanks(line.substr(end_of_coordinates, charge_width))) &&
         is_digit(radius.front()) && is_column_number(radius);
}

Problem parse_pqr_columns(std::string_view line, Record& record) {
  std::string_view rest = line.substr(end_of_coordinates);
  std::string_view radius = take_last(rest);
  std::string_view charge = take_last(rest);
  if (charge.empty() && has_joined_charge_and_radius(line)) {
    charge = without_leading_blanks(line.substr(end_of_coordinates, charge_width));
    radius = line.substr(radius_column, radius_width);
  }
  if (charge.empty()) charge = std::exchange(radius, line.substr(line.size()));
  if (has_extra_number(rest)) return {extra_number, {}, radius};
  record.label = label_of_columns(line);
  return read_pqr_values({coordinate_column(line, 0), coordinate_column(line, 1),
                          coordinate_column(line, 2), charge, radius},
                         record);
}

/// Returns a record with a blank between numbers that run together, as in `-51.730-160.850`; empty
/// if there are none.
std::string with_separate_numbers(std::string_view line) {
  std::string text;
  bool has_point = false;
  for (const char c : line) {
    if (is_blank(c)) has_point = false;
    if (c == '-' && has_point && is_digit(text.back())) {
      text += ' ';
      has_point = false;
    }
    has_point = has_point || c == '.';
    text += c;
  }
  return text.size() == line.size() ? std::string() : text;
}

/// Returns whether a field is an element symbol, optionally with a formal charge: `N`, `Zn`, `O1-`.
bool is_element_field(std::string_view field) {
  std::size_t letters = 0;
  while (letters < field.size() && is_letter(field[letters])) ++letters;
  if (letters < 1 || letters > 2) return false;
  const std::string_view charge = field.substr(letters);
  return charge.empty() ||
         (charge.size() == 2 && is_digit(charge[0]) && (charge[1] == '+' || charge[1] == '-'));
}

/// Removes an element symbol at the end of the line, and returns it without its charge; empty if
/// there is none.
std::string_view take_element(std::string_view& line) {
  std::string_view rest = line;
  std::string_view field = take_last(rest);
  if (!is_element_field(field)) return {};
  line = rest;
  while (!is_letter(field.back())) field.remove_suffix(1);
  return field;
}

/// Returns the text behind the radius of a record, which begins with a word; empty if the record is
/// not valid without it.
std::string_view text_after_radius(std::string_view line) {
  std::string_view rest = line;
  for (;;) {
    double value = 0;
    const std::string_view field = take_last(rest);
    if (field.empty()) return {};
    Record record;
    if (parse_number(field, value) != std::errc{} && !parse_pqr_fields(rest, record))
      return trimmed(line.substr(rest.size()));
  }
}

// ------------------------------------------------------------------ names of records and columns

// https://www.wwpdb.org/documentation/file-format-content/format33/sect1.html, and records of older
// versions and of AutoDock.
constexpr std::string_view known_records =
    "header obslte title split caveat compnd source keywds expdta nummdl mdltyp author revdat "
    "sprsde jrnl remark dbref dbref1 dbref2 seqadv seqres modres het hetnam hetsyn formul helix "
    "sheet turn ssbond link linkr cispep site cryst1 origx1 origx2 origx3 scale1 scale2 scale3 "
    "mtrix1 mtrix2 mtrix3 model atom anisou sigatm siguij ter hetatm endmdl conect master end "
    "tvect hydbnd sltbrg ftnote user root endroot branch endbranch torsdof";

bool is_known_record(std::string_view line) {
  return has_word(known_records, lower_case(std::string(take_first(line).substr(0, 6))));
}

/// Returns the first number behind the word `column` in a text in lower case; 0 if there is none.
int column_in(std::string_view text) {
  const std::size_t word = text.find("column");
  if (word == text.npos) return 0;
  text.remove_prefix(word);
  const std::size_t start = std::min(text.find_first_of("0123456789"), text.size());
  const std::size_t end = std::min(text.find_first_not_of("0123456789", start), text.size());
  int column = 0;
  parse_integer(text.substr(start, end - start), column);
  return column;
}

// ---------------------------------------------------------------- PDB files that are named .pqr
//
// PDB files have the occupancy in columns 55 to 60 and the B-factor in columns 61 to 66, both in
// the format %6.2f. PQR files have charge and radius there.

constexpr std::size_t occupancy_width = 6, b_factor_width = 6;
constexpr std::size_t b_factor_column = end_of_coordinates + occupancy_width;
constexpr std::size_t end_of_b_factor = b_factor_column + b_factor_width;
constexpr double max_radius_of_pqr = 4;  // angstrom; most B-factors are larger
constexpr std::size_t pdbqt_charge_column = end_of_b_factor + 4, pdbqt_charge_width = 6;

/// Reads a number that fills a column of `width` characters and has this number of decimals.
bool read_fixed(std::string_view line, std::size_t column, std::size_t width, std::size_t decimals,
                double& value) {
  const std::string_view text = line.substr(column, width);
  const std::string_view fraction = text.substr(width - decimals);
  return text[width - decimals - 1] == '.' &&
         std::all_of(fraction.begin(), fraction.end(), is_digit) &&
         parse_number(without_leading_blanks(text), value) == std::errc{};
}

// ---------------------------------------------------------------- PQR files that are named .pdb

/// Returns whether a record has the columns of a PDB file: three coordinates, then occupancy and
/// B-factor, which may be blank.
bool has_pdb_columns(std::string_view line, double& occupancy) {
  if (!holds_coordinates(line)) return false;
  if (line.size() > end_of_b_factor && !is_blank(line[end_of_b_factor])) return false;
  double b_factor = 0;
  const auto is_number_or_blank = [](std::string_view text, double& value) {
    return text.empty() || parse_number(text, value) == std::errc{};
  };
  return is_number_or_blank(column_text(line, end_of_coordinates, occupancy_width), occupancy) &&
         is_number_or_blank(column_text(line, b_factor_column, b_factor_width), b_factor);
}

/// Counts of records by their format.
struct RecordCounts {
  static constexpr std::uint64_t max_records = 1000;

  std::uint64_t all = 0;
  std::uint64_t pdb_columns = 0;  ///< have the columns of PDB files
  std::uint64_t pqr = 0;          ///< end with a possible charge and radius
  std::uint64_t only_pqr = 0;     ///< records of `pqr` that are not valid in PDB files
  std::uint64_t with_radius = 0;  ///< records of `pqr` with the radius of a heavy atom

  void add(std::string_view line) {
    constexpr double min_usual_radius = 0.5;  // angstrom; some hydrogens have smaller radii
    ++all;
    double occupancy = 0;
    const bool has_columns = has_pdb_columns(line, occupancy);
    pdb_columns += static_cast<std::uint64_t>(has_columns);
    // More than a tenth of all records cannot be those of a PQR file.
    if (10 * (all - 1 - pqr) > max_records) return;
    Record record;
    if (parse_pqr(line, record) || record.atom.radius > max_radius_of_pqr) return;
    ++pqr;
    only_pqr += static_cast<std::uint64_t>(!has_columns || occupancy < 0);
    with_radius += static_cast<std::uint64_t>(record.atom.radius >= min_usual_radius);
  }

  /// The fractions leave room for unusual records. Charges in the columns of the occupancy are
  /// recognised by their sign, which is negative for about half of the atoms.
  AtomFormat format() const {
    if (all == 0) return AtomFormat::automatic;
    if (10 * pqr >= 9 * all && 10 * only_pqr >= 3 * all && 2 * with_radius >= all)
      return AtomFormat::pqr;
    return 10 * pdb_columns >= 9 * all ? AtomFormat::pdb : AtomFormat::automatic;
  }
};

}  // namespace

bool is_pqr_record(std::string_view line) {
  line = without_leading_blanks(line);
  // The serial number may follow HETATM without a blank.
  if (starts_with_ignoring_case(line, "hetatm")) return true;
  if (!starts_with_ignoring_case(line, "atom")) return false;
  return line.size() == 4 || is_blank(line[4]) || is_digit(line[4]);
}

Problem parse_pqr(std::string_view line, Record& record) {
  const std::string_view whole = line, element = take_element(line);
  const bool has_columns = has_coordinate_columns(line);
  Problem problem = parse_pqr_fields(line, record);
  if (problem && has_columns) problem = parse_pqr_columns(line, record);
  if (!problem && has_columns && has_label_columns(line)) record.label = label_of_columns(line);
  if (problem) {
    Record separate;
    if (const std::string text = with_separate_numbers(line);
        !text.empty() && !parse_pqr_fields(text, separate)) {
      record = std::move(separate);
      problem = {};
    }
  }
  if (problem) {
    if (const std::string_view text = text_after_radius(whole); !text.empty())
      return {trailing_text, {}, text};
  }
  record.label.element = element;
  return problem;
}

bool is_unread_atom(std::string_view line) {
  line = without_leading_blanks(line);
  if (line.empty() || !is_letter(line.front()) || is_pqr_record(line) || is_known_record(line))
    return false;
  Record record;
  return has_coordinate_columns(line) || !parse_pqr(line, record);
}

bool is_pdbqt_record(std::string_view line) {
  constexpr std::size_t end = pdbqt_charge_column + pdbqt_charge_width;
  double charge = 0;
  return line.size() > end + 1 && is_blank(line[end]) && is_letter(line[end + 1]) &&
         read_fixed(line, pdbqt_charge_column, pdbqt_charge_width, 3, charge);
}

void NamedColumns::add(std::string_view line) {
  const std::string_view start = without_leading_blanks(line);
  if (!start.starts_with('#') && !starts_with_ignoring_case(start, "remark")) return;
  const std::string text = lower_case(std::string(start));
  const auto has = [&](std::string_view word) { return text.find(word) != text.npos; };
  if (has("z radius charge") || has("z r q")) {
    radius = 1;
    charge = 2;
  }
  if (has("charge") == has("radi")) return;
  int column = column_in(text);
  // `gmx editconf -mead` names the columns so.
  if (has("occupancy")) column = static_cast<int>(end_of_coordinates) + 1;
  if (has("b-factor")) column = static_cast<int>(b_factor_column) + 1;
  if (column > 0) (has("charge") ? charge : radius) = column;
}

std::string describe_pqr(const Problem& problem, std::string_view line) {
  std::string text =
      problem.pattern == too_few_fields
          ? formatted(too_few_fields, min_leading_fields(line) + pqr_quantities.size(),
                      count_fields(line))
          : describe(problem, line);
  if (problem.pattern != trailing_text && problem.quantity == quantity_radius.name &&
      problem.text.starts_with('-')) {
    std::string_view rest =
        line.substr(0, static_cast<std::size_t>(problem.text.data() - line.data()));
    double charge = 0;
    if (parse_number(take_last(rest), charge) == std::errc{} && charge > 0)
      return text + "; charge and radius seem to be swapped; write the charge before the radius";
  }
  PdbLikeness likeness;
  likeness.add(line);
  if (likeness.layout > 0)
    text += "; this looks like a PDB file, whose occupancy and B-factor are not charge and radius";
  return text;
}

void PdbLikeness::add(std::string_view line) {
  double coordinate = 0, occupancy = 0, b_factor = 0;
  if (!ends_at(line, end_of_b_factor) ||
      !read_fixed(line, b_factor_column, b_factor_width, 2, b_factor) ||
      !read_fixed(line, end_of_coordinates, occupancy_width, 2, occupancy) || occupancy < 0 ||
      occupancy > 1)
    return;
  for (std::size_t column = first_coordinate_column; column < end_of_coordinates;
       column += coordinate_width)
    if (!read_fixed(line, column, coordinate_width, 3, coordinate)) return;
  ++layout;
  // Some programs write 0 for both, or 0 for the B-factor. Charges of 1 with a radius are those of
  // ions.
  const bool has_no_radius = b_factor == 0 && (occupancy == 0 || occupancy == 1);
  if (b_factor > max_radius_of_pqr || has_no_radius) ++values;
}

AtomFormat format_of_records(std::string_view text) {
  RecordCounts counts;
  NamedColumns columns;
  while (!text.empty() && counts.all < RecordCounts::max_records) {
    const std::string_view line = take_line(text);
    if (is_pqr_record(line))
      counts.add(line);
    else
      columns.add(line);
  }
  return counts.all > 0 && columns.are_known() ? AtomFormat::pqr : counts.format();
}

void refuse_pdb_records(std::string_view name, std::uint64_t atoms, const PdbLikeness& likeness) {
  // Most records of PDB files have these formats. PQR files with charges of two decimals do as
  // well, but half of their charges are negative, and PdbLikeness::add does not count those.
  if (10 * likeness.layout < 9 * atoms || 2 * likeness.values < atoms) return;
  throw Error(formatted(
      "{}: this is a PDB file: its columns 55 to 66 hold occupancy and B-factor, which "
      "are not charge and radius; read it with --format pdb, or with --format pqr if they are",
      name));
}

void refuse_pqr_records(std::string_view text, std::string_view name) {
  for (std::string_view rest = text; !rest.empty();)
    if (const std::string_view line = take_line(rest); is_pqr_record(line)) {
      if (is_pdbqt_record(line)) refuse_other_suffix(name, ".pdbqt");
      break;
    }
  if (format_of_records(text) != AtomFormat::pqr) return;
  throw Error(
      formatted("{}: this is a PQR file: its records end with charge and radius instead of "
                "occupancy and B-factor; read it with --format pqr",
                name));
}

}  // namespace eses::detail
