#include "input/atom_reader.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "input/other_formats.hpp"
#include "input/pqr_labels.hpp"
#include "input/text_encoding.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/bytes_text.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Maximum absolute value of a coordinate or radius. Larger numbers come from misread columns or a
// wrong unit, and would give a grid that exceeds any memory.
constexpr double max_length = max_coordinate;

// Length of `0 0 0 0` and a newline, the shortest line of an atom.
constexpr std::size_t min_atom_line_length = 8;  // characters

// Size of the parts in which text is parsed. It is small, so that a large binary file is detected
// early.
constexpr std::size_t part_bytes = std::size_t{1} << 18;
static_assert(max_line_length < part_bytes);

// Memory that reading may always add to that of the process. A limit below it is refused later, by
// the plan, whose message names the smallest sufficient limit.
constexpr std::uint64_t always_granted_bytes = std::uint64_t{4} << 20;

// The largest index is reserved for "no atom".
constexpr std::size_t max_atoms = std::numeric_limits<AtomIndex>::max();

// ---------------------------------------------------------------------------- characters, fields

constexpr bool is_control(char c) {
  // Bitwise operators, because compilers do not vectorize short-circuit evaluation.
  const auto byte = static_cast<unsigned char>(c);
  return ((byte < 0x20) & (c != '\t') & (c != '\n') & (c != '\r')) | (byte == 0x7f);
}

std::size_t count_fields(std::string_view text) {
  std::size_t count = 0;
  while (!take_first(text).empty()) ++count;
  return count;
}

/// Removes the first line from `rest`, and returns it without its end, LF or CRLF.
std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  while (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// --------------------------------------------------------------------------------------- numbers

enum class Fault {
  none,
  missing,
  not_a_number,
  not_finite,
  out_of_range,
  negative,
  too_large,
  too_few_fields,
  extra_number,
  residue_number,
};

struct Quantity {
  std::string_view name;
  double lowest;
  double highest;
};

constexpr double max_double = std::numeric_limits<double>::max();
constexpr Quantity quantity_x{"x", -max_length, max_length};
constexpr Quantity quantity_y{"y", -max_length, max_length};
constexpr Quantity quantity_z{"z", -max_length, max_length};
constexpr Quantity quantity_charge{"charge", -max_double, max_double};
constexpr Quantity quantity_radius{"radius", 0, max_length};

/// The fault of a line. Its message is made only when the line is rejected, because the PQR reader
/// tries two layouts.
struct Problem {
  Fault fault = Fault::none;
  std::string_view quantity;  // name of the quantity
  std::string_view text;      // the field, a view of the line even if empty

  explicit operator bool() const { return fault != Fault::none; }
};

Fault fault_of(std::errc error) {
  if (error == std::errc{}) return Fault::none;
  return error == std::errc::result_out_of_range ? Fault::out_of_range : Fault::not_a_number;
}

Fault check_value(double value, const Quantity& quantity) {
  if (!std::isfinite(value)) return Fault::not_finite;
  if (quantity.lowest == 0 && value < 0) return Fault::negative;
  return value < quantity.lowest || value > quantity.highest ? Fault::too_large : Fault::none;
}

Problem read_value(std::string_view text, const Quantity& quantity, double& value) {
  Fault fault = text.empty() ? Fault::missing : fault_of(parse_number(text, value));
  if (fault == Fault::none) fault = check_value(value, quantity);
  return {fault, quantity.name, text};
}

/// The data of one line.
struct Record {
  Atom atom;
  // only for PQR:
  double charge = 0;
  AtomLabel label;
};

// --------------------------------------------------------------------------------- lines: xyzr

constexpr std::array xyzr_quantities{quantity_x, quantity_y, quantity_z, quantity_radius};

bool is_pqr_record(std::string_view line) {
  line = without_leading_blanks(line);
  // The serial number may follow HETATM without a blank.
  if (starts_with_ignoring_case(line, "hetatm")) return true;
  if (!starts_with_ignoring_case(line, "atom")) return false;
  return line.size() == 4 || is_blank(line[4]) || is_digit(line[4]);
}

bool is_xyzr_record(std::string_view line) {
  line = without_leading_blanks(line);
  return !line.empty() && line.front() != '#';
}

Problem parse_xyzr(std::string_view line, Record& record) {
  std::array<double, xyzr_quantities.size()> values{};
  std::string_view rest = line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const Problem problem = read_value(take_first(rest), xyzr_quantities[i], values[i]))
      return problem;
  }
  record.atom = {{values[0], values[1], values[2]}, values[3]};
  return {};
}

// ---------------------------------------------------------------------------------- lines: PQR
//
// The free format is `ATOM serial name residue [chain] number x y z charge radius`, see
// https://apbs.readthedocs.io/en/latest/formats/pqr.html. Programs that use the columns of PDB
// files may write numbers without a blank between them, see
// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html. Some programs append
// an element symbol, as in PDB files. ESES and APBS ignore it.

constexpr std::array pqr_quantities{quantity_x, quantity_y, quantity_z, quantity_charge,
                                    quantity_radius};
using PqrFields = std::array<std::string_view, pqr_quantities.size()>;

constexpr std::size_t first_coordinate_column = 30;  // 0-based
constexpr std::size_t coordinate_width = 8;
constexpr std::size_t end_of_coordinates = first_coordinate_column + 3 * coordinate_width;
// Widths of charge and radius as pdb2pqr writes them, %8.4f and %7.4f.
constexpr std::size_t charge_width = 8, radius_width = 7;
constexpr std::size_t radius_column = end_of_coordinates + charge_width;
constexpr std::size_t end_of_radius = radius_column + radius_width;

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
  const bool holds_serial = is_digit(record.back());
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

/// Returns whether there are more than five numbers. Such a record is ambiguous: ESES reads the
/// last two numbers as charge and radius, APBS the fourth and fifth.
bool ends_with_decimal(std::string_view leading) { return is_decimal(take_last(leading)); }

Problem parse_pqr_fields(std::string_view line, Record& record) {
  PqrFields fields;
  std::string_view leading = line;
  for (std::size_t i = fields.size(); i-- > 0;) fields[i] = take_last(leading);
  if (count_fields(leading) < min_leading_fields(line)) return {Fault::too_few_fields, {}, line};
  const Problem problem = read_pqr_values(fields, record);
  if (!problem && ends_with_decimal(leading)) return {Fault::extra_number, {}, fields.back()};
  // If two errors apply, the one about text that is not a number is clearer.
  if (problem.fault != Fault::not_a_number && looks_like_residue_number(fields[0], leading)) {
    return {Fault::residue_number, quantity_x.name, fields[0]};
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
  double value = 0;
  return !text.empty() && is_digit(text.back()) && text.find('.') != std::string_view::npos &&
         parse_number(text, value) == std::errc{};
}

bool has_coordinate_columns(std::string_view line) {
  if (line.size() < end_of_coordinates || !is_blank(line[first_coordinate_column - 1]))
    return false;
  const std::string_view rest = line.substr(end_of_coordinates);
  if (!rest.empty() && !is_blank(rest[0]) && rest[0] != '-' && rest[0] != '+') return false;
  return is_column_number(coordinate_column(line, 0)) &&
         is_column_number(coordinate_column(line, 1)) &&
         is_column_number(coordinate_column(line, 2));
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
  if (ends_with_decimal(rest)) return {Fault::extra_number, {}, radius};
  record.label = label_of_columns(line);
  return read_pqr_values({coordinate_column(line, 0), coordinate_column(line, 1),
                          coordinate_column(line, 2), charge, radius},
                         record);
}

/// Returns whether a field is an element symbol, optionally with a formal charge: `N`, `Zn`, `O1-`.
bool is_element(std::string_view field) {
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
  if (!is_element(field)) return {};
  line = rest;
  while (!is_letter(field.back())) field.remove_suffix(1);
  return field;
}

Problem parse_pqr(std::string_view line, Record& record) {
  const std::string_view element = take_element(line);
  Problem problem = parse_pqr_fields(line, record);
  if (problem && has_coordinate_columns(line)) problem = parse_pqr_columns(line, record);
  record.label.element = element;
  return problem;
}

// ------------------------------------------------------------------------- waters of PQR files

// Names of water in the PDB, in force fields, and in files of GROMACS. Other names of water in
// programs of molecular dynamics are those of ligands in the PDB.
constexpr std::array<std::string_view, 10> water_residues{"HOH",  "WAT",  "H2O",  "DOD",  "SOL",
                                                          "TIP2", "TIP3", "TIP4", "TIP5", "SPCE"};

/// Adds the last atom of a PQR file to the diagnostics if it belongs to water.
void inspect_residue(std::string_view residue, AtomFile& file) {
  if (std::find(water_residues.begin(), water_residues.end(), residue) == water_residues.end())
    return;
  if (file.diagnostics.empty()) file.diagnostics.push_back({DiagnosticKind::water, 0, {}});
  Diagnostic& water = file.diagnostics.front();
  const auto atom = static_cast<AtomIndex>(file.atoms.size() - 1);
  if (++water.count <= Diagnostic::max_examples) water.examples.push_back({atom, atom});
}

// ---------------------------------------------------------------- PDB files that are named .pqr
//
// PDB files have the occupancy in columns 55 to 60 and the B-factor in columns 61 to 66, both in
// the format %6.2f. PQR files have charge and radius there.

constexpr std::size_t occupancy_width = 6, b_factor_width = 6;
constexpr std::size_t b_factor_column = end_of_coordinates + occupancy_width;
constexpr std::size_t end_of_b_factor = b_factor_column + b_factor_width;
constexpr double max_usual_radius = 4;  // angstrom; most B-factors are larger

/// Reads a number that fills a column of `width` characters and has this number of decimals.
bool read_fixed(std::string_view line, std::size_t column, std::size_t width, std::size_t decimals,
                double& value) {
  const std::string_view text = line.substr(column, width);
  const std::string_view fraction = text.substr(width - decimals);
  return text[width - decimals - 1] == '.' &&
         std::all_of(fraction.begin(), fraction.end(), is_digit) &&
         parse_number(without_leading_blanks(text), value) == std::errc{};
}

/// Updates the counts with a record.
void add_record(std::string_view line, PdbLikeness& likeness) {
  double x = 0, y = 0, z = 0, occupancy = 0, b_factor = 0;
  const auto read = [line](std::size_t column, std::size_t width, std::size_t decimals,
                           double& value) {
    return read_fixed(line, column, width, decimals, value);
  };
  constexpr std::size_t first = first_coordinate_column, width = coordinate_width;
  if (line.size() < end_of_b_factor || !ends_at(line, end_of_b_factor) ||
      !read(b_factor_column, b_factor_width, 2, b_factor) ||
      !read(end_of_coordinates, occupancy_width, 2, occupancy) || !read(first, width, 3, x) ||
      !read(first + width, width, 3, y) || !read(first + 2 * width, width, 3, z))
    return;
  if (occupancy < 0 || occupancy > 1) return;
  ++likeness.layout;
  // Some programs write 0 for both.
  if (occupancy == 1 || b_factor > max_usual_radius || (occupancy == 0 && b_factor == 0))
    ++likeness.values;
}

// ---------------------------------------------------------------- PQR files that are named .pdb

/// Returns whether a record has the columns of a PDB file: three coordinates, then occupancy and
/// B-factor, which may be blank.
bool has_pdb_columns(std::string_view line, double& occupancy) {
  if (line.size() < end_of_coordinates) return false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!is_column_number(coordinate_column(line, axis))) return false;
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
  std::uint64_t all = 0;
  std::uint64_t pdb_columns = 0;  ///< have the columns of PDB files
  std::uint64_t pqr = 0;          ///< end with a possible charge and radius
  std::uint64_t only_pqr = 0;     ///< do so, and are not valid in PDB files
  std::uint64_t with_radius = 0;  ///< do so, and have the radius of an atom other than hydrogen

  void add(std::string_view line) {
    constexpr double min_usual_radius = 0.5;  // angstrom; some hydrogens have smaller radii
    ++all;
    double occupancy = 0;
    const bool has_columns = has_pdb_columns(line, occupancy);
    pdb_columns += static_cast<std::uint64_t>(has_columns);
    Record record;
    if (parse_pqr(line, record) || record.atom.radius > max_usual_radius) return;
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

/// Returns the format of the ATOM and HETATM records of a text, AtomFormat::pdb or AtomFormat::pqr,
/// or AtomFormat::automatic if it is unknown. A part of the records suffices.
AtomFormat format_of_records(std::string_view text) {
  constexpr std::uint64_t max_records = 1000;
  RecordCounts counts;
  while (!text.empty() && counts.all < max_records)
    if (const std::string_view line = take_line(text); is_pqr_record(line)) counts.add(line);
  return counts.format();
}

// -------------------------------------------------------------------------------------- messages

[[noreturn]] void fail(std::string_view name, std::size_t line, std::string_view what) {
  throw Error(formatted("{}:{}: {}", name, line, what));
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
      return formatted("{} is beyond the limit of {:.0f} angstrom", text, max_length);
    case Fault::residue_number:
      return text + " seems to be the residue number; expected x y z charge radius at the end";
    case Fault::none:
    case Fault::too_few_fields:
    case Fault::extra_number:
      break;
  }
  return {};
}

std::string description(const Problem& problem, std::string_view line) {
  if (problem.fault == Fault::too_few_fields) {
    return formatted(
        "expected at least {} fields, the last five being x y z charge radius, found {}",
        min_leading_fields(line) + pqr_quantities.size(), count_fields(line));
  }
  if (problem.fault == Fault::extra_number)
    return "more than five numbers, expected x y z charge radius; remove the fields after the "
           "radius";
  const auto start = static_cast<std::size_t>(problem.text.data() - line.data());
  return formatted("field {} ({}): {}", count_fields(line.substr(0, start)) + 1, problem.quantity,
                   reason(problem));
}

std::string describe_pqr(const Problem& problem, std::string_view line) {
  std::string text = description(problem, line);
  PdbLikeness likeness;
  add_record(line, likeness);
  if (likeness.layout > 0)
    text += "; this looks like a PDB file, whose occupancy and B-factor are not charge and radius";
  return text;
}

/// Describes the fault of a line. `rest` is the text from this line on.
std::string describe_xyzr(const Problem& problem, std::string_view line, std::string_view rest) {
  std::string text = description(problem, line);
  const bool is_first_field = problem.quantity == quantity_x.name;
  if (problem.fault != Fault::not_a_number || !is_first_field) return text;
  const AtomFormat format = format_of_records(rest);
  if (format == AtomFormat::pdb)
    text += "; this looks like a PDB file; read it with --format pdb";
  else if (format == AtomFormat::pqr)
    text += "; this looks like a PQR file; read it with --format pqr";
  else if (is_pqr_record(line))
    text += "; this looks like a PDB or PQR file; read it with --format pdb or --format pqr";
  return text;
}

// ------------------------------------------------------------------------------------------ text

/// Scans the whole text without an early exit, so that the loop is vectorized.
bool holds_control_character(std::string_view text) {
  unsigned char found = 0;
  for (const char c : text) found = static_cast<unsigned char>(found | is_control(c));
  return found != 0;
}

void check_is_text(std::string_view text, std::string_view name, std::size_t first_line) {
  if (!holds_control_character(text)) return;
  const auto culprit = std::find_if(text.begin(), text.end(), is_control);
  const auto line = static_cast<std::size_t>(std::count(text.begin(), culprit, '\n'));
  fail(name, first_line + line,
       formatted("control character \\x{:02x}; this looks like a binary file, not text",
                 static_cast<unsigned>(*culprit)));
}

/// Throws Error with the name of the format if a text is a PDB or mmCIF file. PQR files may keep
/// the header of the PDB file from which they were made.
void refuse_structure(std::string_view text, std::string_view name, AtomFormat format) {
  const AtomFormat found = structure_format_of(text);
  if (found == AtomFormat::mmcif)
    throw Error(formatted("{}: this is an mmCIF file; read it with --format mmcif", name));
  if (found == AtomFormat::pdb && format != AtomFormat::pqr)
    throw Error(formatted("{}: this is a PDB file; read it with --format pdb", name));
}

bool is_model_record(std::string_view line) {
  return starts_with_ignoring_case(line, "model") && (line.size() == 5 || is_blank(line[5]));
}

/// Returns the number of a MODEL record. Throws Error if there is none.
int model_number(std::string_view line, std::string_view name, std::size_t number) {
  std::string_view rest = line;
  take_first(rest);
  const std::string_view field = take_first(rest);
  int model = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), model);
  if (error != std::errc{} || end != field.data() + field.size())
    fail(name, number, formatted("expected the number of the model, found {}", quoted(field)));
  return model;
}

void check_line(std::string_view line, std::string_view name, std::size_t number) {
  // A file with CR line ends would otherwise be read as one line, with one atom and extra columns.
  if (line.find('\r') != std::string_view::npos) {
    fail(name, number, "carriage return inside the line; expected LF or CRLF line ends");
  }
  if (line.size() > max_line_length) {
    fail(name, number, formatted("more than {} characters in the line", max_line_length));
  }
}

/// Returns an upper bound of the number of atoms, for the capacity of the vector. Blank lines are
/// not counted.
std::size_t estimate_atoms(std::string_view text) {
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  return std::min(lines, text.size() / min_atom_line_length + 1);
}

// ----------------------------------------------------------------------------------------- files

[[noreturn]] void fail_for_memory(std::string_view name) {
  throw MemoryLimitError(formatted("cannot read {}: out of memory", name));
}

/// Calls `take` with parts of a text that consist of whole lines. A line longer than the limit may
/// be split.
void for_whole_lines(const ReadText& read, const std::function<void(std::string_view text)>& take) {
  std::vector<char> buffer(part_bytes);
  for (std::size_t used = 0;;) {
    const std::size_t count = read(std::span(buffer).subspan(used));
    const std::string_view text(buffer.data(), used + count);
    const bool is_last = count == 0;
    const std::size_t newline = text.rfind('\n');
    const bool has_end = newline != text.npos;
    const bool is_whole = is_last || (!has_end && text.size() > max_line_length);
    const std::size_t taken = is_whole ? text.size() : has_end ? newline + 1 : 0;
    if (taken > 0) take(text.substr(0, taken));
    if (is_last) return;
    std::copy(text.begin() + static_cast<std::ptrdiff_t>(taken), text.end(), buffer.begin());
    used = text.size() - taken;
  }
}

/// Keeps the resident memory within the limit while the lists of atoms grow.
class GrowthLimit {
 public:
  explicit GrowthLimit(const AtomLines& lines)
      : lines_(lines), max_resident_(max_resident_while_reading(lines.max_memory)) {}

  /// Reserves memory for `added` more atoms. Throws Error if it exceeds the limit.
  void make_room(std::size_t added, std::uint64_t line, AtomFile& result) const {
    const std::size_t wanted = result.atoms.size() + added;
    const bool is_copied = wanted > result.atoms.capacity();
    require(bytes_per_atom() * (is_copied ? wanted : added), result.atoms.size(), line);
    grow(added, result.atoms);
    grow(added, result.lines);
    if (!has_labels()) return;
    grow(added, result.labels);
    grow(added, result.charges);
  }

 private:
  bool has_labels() const { return lines_.with_labels && lines_.format == AtomFormat::pqr; }

  std::uint64_t bytes_per_atom() const {
    return sizeof(Atom) + sizeof(std::uint64_t) +
           (has_labels() ? sizeof(AtomLabel) + sizeof(double) : 0);
  }

  void require(std::uint64_t bytes, std::size_t atoms, std::uint64_t line) const {
    if (lines_.max_memory == 0 || resident_memory() + bytes <= max_resident_) return;
    throw LimitExceeded(
        formatted("{}:{}: reading more than {} atoms exceeds the memory limit of {}; use a larger "
                  "limit",
                  lines_.name, line, atoms, binary_bytes_text(lines_.max_memory)));
  }

  template <class Value>
  static void grow(std::size_t added, std::vector<Value>& list) {
    const std::size_t wanted = list.size() + added;
    if (wanted > list.capacity()) list.reserve(std::max(wanted, 2 * list.capacity()));
  }

  const AtomLines& lines_;
  std::uint64_t max_resident_;
};

AtomFile finished(AtomFile atoms, const LinesRead& read, const AtomLines& lines) {
  if (atoms.atoms.empty())
    throw Error(no_atoms_message(lines.name, lines.format, read.lines, lines.model));
  if (lines.model == 0) refuse_models(lines.name, read.models);
  refuse_pdb_records(lines.name, atoms.atoms.size(), read.likeness);
  return atoms;
}

AtomFile read_descriptor(int descriptor, const ReadOptions& options, const std::string& name,
                         const std::function<void(AtomFile& atoms)>& after_part) {
  const AtomLines lines{.format = options.format,
                        .name = name,
                        .with_labels = options.with_labels,
                        .max_memory = options.max_memory,
                        .model = options.structure.model};
  try {
    TextSource source(descriptor, name);
    AtomFile atoms;
    const LinesRead read = read_atom_lines(
        [&source](std::span<char> buffer) { return source.read(buffer); }, lines, atoms,
        [&] {
          if (after_part) after_part(atoms);
        });
    return finished(std::move(atoms), read, lines);
  } catch (const std::bad_alloc&) {
    fail_for_memory(name);
  } catch (const std::length_error&) {
    fail_for_memory(name);
  }
}

}  // namespace

LinesRead parse_atom_lines(std::string_view text, const AtomLines& lines, AtomFile& result) {
  const auto& [format, name, first_line, with_labels, max_memory, model, model_before] = lines;
  if (first_line == 1) {
    refuse_wide_characters(text, name);
    text = without_byte_order_mark(text);
    refuse_other_formats(text, name);
    refuse_structure(text, name, format);
  }
  check_is_text(text, name, first_line);
  const bool is_pqr = format == AtomFormat::pqr;
  const auto is_record = is_pqr ? is_pqr_record : is_xyzr_record;
  const auto parse_line = is_pqr ? parse_pqr : parse_xyzr;

  auto& [atoms, line_numbers, labels, charges, structure, diagnostics] = result;
  LinesRead read;
  read.last_model = model_before;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    const std::uint64_t number = first_line + read.lines++;
    check_line(line, name, number);
    if (is_pqr && is_model_record(line)) {
      ++read.models;
      read.last_model = model_number(line, name, number);
    }
    if (!is_record(line) || (is_pqr && model != 0 && read.last_model != model)) continue;
    Record record;
    if (const Problem problem = parse_line(line, record)) {
      const std::string_view rest(
          line.data(), static_cast<std::size_t>(text.data() + text.size() - line.data()));
      fail(name, number, is_pqr ? describe_pqr(problem, line) : describe_xyzr(problem, line, rest));
    }
    if (atoms.size() == max_atoms) {
      fail(name, number, formatted("more than {} atoms", max_atoms));
    }
    if (is_pqr) add_record(line, read.likeness);
    atoms.push_back(record.atom);
    line_numbers.push_back(number);
    if (is_pqr) inspect_residue(record.label.residue, result);
    if (!is_pqr || !with_labels) continue;
    labels.push_back(std::move(record.label));
    charges.push_back(record.charge);
  }
  return read;
}

LinesRead read_atom_lines(const ReadText& read, const AtomLines& lines, AtomFile& result,
                          const std::function<void()>& after_part) {
  const GrowthLimit limit(lines);
  LinesRead all;
  for_whole_lines(read, [&](std::string_view text) {
    AtomLines piece = lines;
    piece.first_line += all.lines;
    piece.model_before = all.models == 0 ? lines.model_before : all.last_model;
    limit.make_room(estimate_atoms(text), piece.first_line, result);
    const LinesRead part = parse_atom_lines(text, piece, result);
    all.lines += part.lines;
    all.likeness.layout += part.likeness.layout;
    all.likeness.values += part.likeness.values;
    all.models += part.models;
    all.last_model = part.last_model;
    if (after_part) after_part();
  });
  return all;
}

void refuse_pdb_records(std::string_view name, std::uint64_t atoms, const PdbLikeness& likeness) {
  // Most records of PDB files have these formats. PQR files with charges of two decimals do as
  // well, but half of their charges are negative, and add_record does not count those.
  if (10 * likeness.layout < 9 * atoms || 2 * likeness.values < atoms) return;
  throw Error(
      formatted("{}: this is a PDB file: its columns 55 to 66 hold occupancy and B-factor, which "
                "are not charge and radius; read it with --format pdb",
                name));
}

void refuse_pqr_records(std::string_view text, std::string_view name) {
  if (format_of_records(text) != AtomFormat::pqr) return;
  throw Error(
      formatted("{}: this is a PQR file: its records end with charge and radius instead of "
                "occupancy and B-factor; read it with --format pqr",
                name));
}

std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model) {
  const bool has_records = format == AtomFormat::pqr || format == AtomFormat::pdb;
  return formatted("{}: no {} found{}; {} {} read", name,
                   has_records ? "ATOM or HETATM records" : "atoms",
                   model == 0 ? "" : formatted(" in model {} (--model)", model), lines,
                   lines == 1 ? "line" : "lines");
}

std::uint64_t max_resident_while_reading(std::uint64_t max_memory) {
  if (max_memory == 0) return 0;
  return std::max(max_memory, resident_memory() + always_granted_bytes);
}

void refuse_models(std::string_view name, std::uint64_t models) {
  if (models < 2) return;
  throw Error(
      formatted("{}: {} models, whose atoms lie on top of each other; choose one with "
                "--model N",
                name, models));
}

bool is_assembly_file(const std::filesystem::path& path) {
  constexpr std::string_view start = ".pdb";
  const std::string suffix = input_suffix(path);
  return suffix.starts_with(start) && suffix.size() > start.size() &&
         std::all_of(suffix.begin() + start.size(), suffix.end(), is_digit);
}

AtomFormat format_of(const std::filesystem::path& path, AtomFormat format) {
  if (format != AtomFormat::automatic) return format;
  const std::string suffix = input_suffix(path);
  if (suffix == ".pqr") return AtomFormat::pqr;
  if (suffix == ".pdb" || suffix == ".ent" || is_assembly_file(path)) return AtomFormat::pdb;
  for (const std::string_view known : {".cif", ".mmcif", ".mcif", ".pdbx"})
    if (suffix == known) return AtomFormat::mmcif;
  return AtomFormat::xyzr;
}

AtomFile parse_atom_text(std::string_view text, const AtomLines& lines) {
  AtomFile atoms;
  GrowthLimit(lines).make_room(estimate_atoms(text), 1, atoms);
  const LinesRead read = parse_atom_lines(text, lines, atoms);
  return finished(std::move(atoms), read, lines);
}

AtomFile read_atom_file(const std::filesystem::path& path, const ReadOptions& options,
                        const std::function<void(AtomFile& atoms)>& after_part) {
  if (path == "-") return read_descriptor(STDIN_FILENO, options, "<stdin>", after_part);
  const std::string name = path.string();
  if (options.format == AtomFormat::automatic) refuse_other_suffix(path);
  const FileDescriptor file(open_for_reading(path, name));
  ReadOptions known = options;
  known.format = format_of(path, options.format);
  return read_descriptor(file.value(), known, name, after_part);
}

}  // namespace eses::detail
