#include "eses/read_atoms.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "io/atom_lines.hpp"
#include "io/file_descriptor.hpp"
#include "io/gzip.hpp"
#include "io/pqr_labels.hpp"
#include "io/text_fields.hpp"

namespace eses {
namespace {

// Far beyond any molecule; a larger number is a misread column or a wrong unit, and would give a
// grid that nobody can hold.
constexpr double largest_length = 1e6;  // angstrom

// `0 0 0 0` and a newline: no atom takes less text.
constexpr std::size_t shortest_atom_line = 8;  // characters

// What one read asks for: no more than the file has, unless its size is unknown, and little enough
// that a large binary file passed by mistake is noticed at once.
constexpr std::size_t smallest_read = std::size_t{1} << 16;  // bytes
constexpr std::size_t largest_read = std::size_t{1} << 20;   // bytes

// The largest index stays free, so that it may stand for "no atom".
constexpr std::size_t most_atoms = std::numeric_limits<AtomIndex>::max();

// ---------------------------------------------------------------------------- characters, fields

constexpr bool is_control(char c) {
  // Bitwise, as the compiler vectorises no short-circuits.
  const auto byte = static_cast<unsigned char>(c);
  return ((byte < 0x20) & (c != '\t') & (c != '\n') & (c != '\r')) | (byte == 0x7f);
}

bool starts_with_ignoring_case(std::string_view text, std::string_view lower_case_prefix) {
  return text.size() >= lower_case_prefix.size() &&
         std::equal(lower_case_prefix.begin(), lower_case_prefix.end(), text.begin(),
                    [](char expected, char c) { return lower_case(c) == expected; });
}

std::size_t count_fields(std::string_view text) {
  std::size_t count = 0;
  while (!take_first(text).empty()) ++count;
  return count;
}

/// Removes the first line from `rest`; its end, LF or CRLF, is not part of it.
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
  residue_number,
  pqr_record,
};

struct Quantity {
  std::string_view name;
  double lowest;
  double highest;
};

constexpr double largest_double = std::numeric_limits<double>::max();
constexpr Quantity quantity_x{"x", -largest_length, largest_length};
constexpr Quantity quantity_y{"y", -largest_length, largest_length};
constexpr Quantity quantity_z{"z", -largest_length, largest_length};
constexpr Quantity quantity_charge{"charge", -largest_double, largest_double};
constexpr Quantity quantity_radius{"radius", 0, largest_length};

/// What is wrong with a line; text for the user is made of it only when it is final, because the
/// PQR reader tries two layouts.
struct Problem {
  Fault fault = Fault::none;
  std::string_view quantity;  // name
  std::string_view text;      // the field, a part of the line even if empty

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

/// What one line tells.
struct Record {
  Atom atom;
  AtomLabel label;  // of PQR only
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
    Problem problem = read_value(take_first(rest), xyzr_quantities[i], values[i]);
    if (!problem) continue;
    if (i == 0 && is_pqr_record(line)) problem.fault = Fault::pqr_record;
    return problem;
  }
  record.atom = {{values[0], values[1], values[2]}, values[3]};
  return {};
}

// ---------------------------------------------------------------------------------- lines: PQR
//
// `ATOM serial name residue [chain] number x y z charge radius`, free format:
// https://apbs.readthedocs.io/en/latest/formats/pqr.html
// Programs that keep to the columns of PDB files write coordinates without a blank in between,
// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html

constexpr std::array pqr_quantities{quantity_x, quantity_y, quantity_z, quantity_charge,
                                    quantity_radius};
using PqrFields = std::array<std::string_view, pqr_quantities.size()>;

constexpr std::size_t first_coordinate_column = 30;  // 0-based
constexpr std::size_t coordinate_width = 8;
constexpr std::size_t end_of_coordinates = first_coordinate_column + 3 * coordinate_width;

Problem read_pqr_values(const PqrFields& fields, Atom& atom) {
  std::array<double, pqr_quantities.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (Problem problem = read_value(fields[i], pqr_quantities[i], values[i])) return problem;
  }
  atom = {{values[0], values[1], values[2]}, values[4]};
  return {};
}

/// Record, serial, name, residue and residue number; the chain may be absent.
std::size_t fewest_leading_fields(std::string_view line) {
  std::string_view rest = line;
  const std::string_view record = take_first(rest);
  const bool holds_serial = is_digit(record.back());
  return holds_serial ? 4 : 5;
}

/// Where charge or radius is missing, counting from the end takes the residue number for x, and
/// the atom would be read without complaint.
bool looks_like_residue_number(std::string_view x, std::string_view leading) {
  const bool is_integer =
      std::all_of(x.begin(), x.end(), [](char c) { return c == '-' || is_digit(c); });
  const std::string_view before = take_last(leading);
  return is_integer && std::none_of(before.begin(), before.end(), is_digit);
}

Problem parse_pqr_fields(std::string_view line, Record& record) {
  PqrFields fields;
  std::string_view leading = line;
  for (std::size_t i = fields.size(); i-- > 0;) fields[i] = take_last(leading);
  if (count_fields(leading) < fewest_leading_fields(line)) return {Fault::too_few_fields, {}, line};
  const Problem problem = read_pqr_values(fields, record.atom);
  // Of two complaints the plainer one: text that is no number.
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

/// A decimal point and a digit at the end are demanded because then no number of a line in free
/// format, wherever the columns cut it, passes for two.
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

Problem parse_pqr_columns(std::string_view line, Record& record) {
  std::string_view rest = line.substr(end_of_coordinates);
  std::string_view radius = take_last(rest);
  std::string_view charge = take_last(rest);
  if (charge.empty()) charge = std::exchange(radius, line.substr(line.size()));
  record.label = label_of_columns(line);
  return read_pqr_values({coordinate_column(line, 0), coordinate_column(line, 1),
                          coordinate_column(line, 2), charge, radius},
                         record.atom);
}

Problem parse_pqr(std::string_view line, Record& record) {
  const Problem problem = parse_pqr_fields(line, record);
  return problem && has_coordinate_columns(line) ? parse_pqr_columns(line, record) : problem;
}

// -------------------------------------------------------------------------------------- messages

[[noreturn]] void fail(std::string_view name, std::size_t line, std::string_view what) {
  throw Error(fmt::format("{}:{}: {}", name, line, what));
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
      return fmt::format("{} is beyond the limit of {:.0f} angstrom", text, largest_length);
    case Fault::residue_number:
      return text + " seems to be the residue number; expected x y z charge radius at the end";
    case Fault::pqr_record:
      return "expected a number, found " + text + "; is this a PQR file, read as xyzr?";
    case Fault::none:
    case Fault::too_few_fields:
      break;
  }
  return {};
}

std::string describe(const Problem& problem, std::string_view line) {
  if (problem.fault == Fault::too_few_fields) {
    return fmt::format(
        "expected at least {} fields, the last five being x y z charge radius, found {}",
        fewest_leading_fields(line) + pqr_quantities.size(), count_fields(line));
  }
  const auto start = static_cast<std::size_t>(problem.text.data() - line.data());
  return fmt::format("field {} ({}): {}", count_fields(line.substr(0, start)) + 1, problem.quantity,
                     reason(problem));
}

// ------------------------------------------------------------------------------------------ text

void check_encoding(std::string_view text, std::string_view name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    fail(name, 1, "UTF-16 text; convert the file to UTF-8 first");
  }
}

/// Without an early exit, so that the loop over all of the text is vectorised.
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
       fmt::format("control character \\x{:02x}; this looks like a binary file, not text",
                   static_cast<unsigned>(*culprit)));
}

void check_line(std::string_view line, std::string_view name, std::size_t number) {
  // Else a file whose lines all end in CR would be one line, with one atom and further columns.
  if (line.find('\r') != std::string_view::npos) {
    fail(name, number, "carriage return inside the line; lines must end in LF or CRLF");
  }
  if (line.size() > longest_line) {
    fail(name, number,
         fmt::format("line of {} characters; at most {} are allowed", line.size(), longest_line));
  }
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

/// An upper bound of the number of atoms, so that the vector need not grow; blank lines, however
/// many, do not inflate it.
std::size_t estimate_atoms(std::string_view text) {
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  return std::min(lines, text.size() / shortest_atom_line + 1);
}

// ----------------------------------------------------------------------------------------- files

[[noreturn]] void fail_with_system_error(std::string_view action, std::string_view name, int code) {
  throw Error(fmt::format("cannot {} {}: {}", action, name, std::generic_category().message(code)));
}

[[noreturn]] void fail_for_memory(std::string_view name) {
  throw Error(fmt::format("cannot read {}: out of memory", name));
}

}  // namespace

int open_for_reading(const std::filesystem::path& path, std::string_view name) {
  int descriptor = -1;
  do {
    descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) fail_with_system_error("open", name, errno);
  return descriptor;
}

namespace {

std::size_t read_some(int descriptor, char* buffer, std::size_t size, std::string_view name) {
  ssize_t count = 0;
  do {
    count = ::read(descriptor, buffer, size);
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail_with_system_error("read", name, errno);
  return static_cast<std::size_t>(count);
}

/// 0 where the size is not known beforehand: pipes, devices, /proc.
std::size_t size_hint(int descriptor, std::string_view name) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail_with_system_error("read", name, errno);
  return S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) : 0;
}

/// All of the file, decompressed if it is a gzip file, or its beginning up to some NUL: it is no
/// text then, and a device such as /dev/zero has no end.
std::string read_text(int descriptor, std::string_view name) {
  std::string text;
  const std::size_t hint = size_hint(descriptor, name);
  const std::size_t chunk = std::clamp(hint + 1, smallest_read, largest_read);
  text.reserve(hint + chunk);
  std::size_t used = 0;
  while (true) {
    if (used == text.size()) text.resize(used + chunk);
    const std::size_t count = read_some(descriptor, text.data() + used, text.size() - used, name);
    const std::string_view piece(text.data() + used, count);
    used += count;
    if (count == 0) break;
    if (piece.find('\0') != std::string_view::npos && !is_gzip(text)) break;
  }
  text.resize(used);
  return is_gzip(text) ? decompressed(text, name) : text;
}

/// In lower case, and of `NAME.pqr.gz` the `.pqr`.
std::string suffix_of(const std::filesystem::path& path) {
  std::string suffix = lower_case(path.extension().string());
  return suffix == ".gz" ? suffix_of(path.stem()) : suffix;
}

NumberedAtoms read_descriptor(int descriptor, AtomFormat format, const std::string& name) {
  try {
    return parse_numbered_atoms(read_text(descriptor, name), format, name);
  } catch (const std::bad_alloc&) {
    fail_for_memory(name);
  } catch (const std::length_error&) {
    fail_for_memory(name);
  }
}

}  // namespace

std::uint64_t parse_atom_lines(std::string_view text, AtomFormat format, std::string_view name,
                               std::uint64_t first_line, bool with_labels, NumberedAtoms& result) {
  if (first_line == 1) check_encoding(text, name);
  check_is_text(text, name, first_line);
  if (first_line == 1) text = without_byte_order_mark(text);
  const bool is_pqr = format == AtomFormat::pqr;
  const auto is_record = is_pqr ? is_pqr_record : is_xyzr_record;
  const auto parse_line = is_pqr ? parse_pqr : parse_xyzr;

  auto& [atoms, lines, labels] = result;
  std::uint64_t line_number = first_line - 1;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    check_line(line, name, ++line_number);
    if (!is_record(line)) continue;
    Record record;
    if (const Problem problem = parse_line(line, record)) {
      fail(name, line_number, describe(problem, line));
    }
    if (atoms.size() == most_atoms) {
      fail(name, line_number, fmt::format("more than {} atoms", most_atoms));
    }
    atoms.push_back(record.atom);
    lines.push_back(line_number);
    if (is_pqr && with_labels) labels.push_back(std::move(record.label));
  }
  return line_number - (first_line - 1);
}

std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines) {
  return fmt::format("{}: no {} found; {} {} read", name,
                     format == AtomFormat::pqr ? "ATOM or HETATM records" : "atoms", lines,
                     lines == 1 ? "line" : "lines");
}

// Whoever reads such a file as PQR takes temperature factors for radii.
void refuse_structure_files(const std::filesystem::path& path) {
  const std::string suffix = suffix_of(path), name = path.string();
  for (const std::string_view format : {".pdb", ".ent", ".cif", ".mmcif"})
    if (suffix == format)
      throw Error(
          fmt::format("{}: {} files have no radii; make a PQR file of it with pdb2pqr, as "
                      "scripts/pdbbind does",
                      name, format));
}

NumberedAtoms parse_numbered_atoms(std::string_view text, AtomFormat format,
                                   std::string_view name) {
  NumberedAtoms result;
  result.atoms.reserve(estimate_atoms(text));
  result.lines.reserve(result.atoms.capacity());
  if (format == AtomFormat::pqr) result.labels.reserve(result.atoms.capacity());
  const std::uint64_t lines = parse_atom_lines(text, format, name, 1, true, result);
  if (result.atoms.empty()) throw Error(no_atoms_message(name, format, lines));
  return result;
}

std::vector<Atom> parse_atoms(std::string_view text, AtomFormat format, std::string_view name) {
  return parse_numbered_atoms(text, format, name).atoms;
}

AtomFormat format_of(const std::filesystem::path& path, AtomFormat format) {
  if (format != AtomFormat::automatic) return format;
  return suffix_of(path) == ".pqr" ? AtomFormat::pqr : AtomFormat::xyzr;
}

NumberedAtoms read_numbered_atoms(const std::filesystem::path& path, AtomFormat format) {
  if (path == "-") return read_descriptor(STDIN_FILENO, format, "<stdin>");
  const std::string name = path.string();
  refuse_structure_files(path);
  const FileDescriptor file(open_for_reading(path, name));
  return read_descriptor(file.value(), format_of(path, format), name);
}

std::vector<Atom> read_atoms(const std::filesystem::path& path, AtomFormat format) {
  return read_numbered_atoms(path, format).atoms;
}

}  // namespace eses
