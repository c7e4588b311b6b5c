#include "input/atom_reader.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "input/atom_records.hpp"
#include "input/other_formats.hpp"
#include "input/pdb_elements.hpp"
#include "input/text_fields.hpp"
#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Length of `0 0 0 0` and a newline, the shortest line of an atom.
constexpr std::size_t min_atom_line_length = 8;  // characters

// Size of the parts in which text is parsed. It is small, so that a large binary file is detected
// early.
constexpr std::size_t part_bytes = std::size_t{1} << 18;
static_assert(max_line_length < part_bytes);

// The largest index is reserved for "no atom".
constexpr std::size_t max_atoms_of_file = std::numeric_limits<AtomIndex>::max();

/// Counts of the text read so far.
struct LinesRead {
  std::uint64_t lines = 0;
  PdbLikeness likeness;
  std::uint64_t models = 0;   ///< number of MODEL records
  int last_model = 1;         ///< Atoms outside of all models belong to model 1.
  NamedColumns columns = {};  ///< the columns of charge and radius, if remarks name them
};

// ------------------------------------------------------------------------------------------ xyzr

constexpr std::array xyzr_quantities{quantity_x, quantity_y, quantity_z, quantity_radius};

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

/// Describes the fault of a line of a file. `rest` is the text from this line on.
std::string describe_xyzr(const Problem& problem, std::string_view line, std::string_view rest,
                          std::string_view name) {
  std::string text = describe(problem, line);
  if (problem.text.find_first_of(",;") != problem.text.npos)
    return text + "; separate the fields by blanks, and write numbers with a decimal point";
  if (int atoms = 0; problem.text.empty() && parse_integer(trimmed(line), atoms))
    return text +
           "; is it the number of atoms of an XYZ file? These have no radii; convert it to a PDB "
           "file";
  const bool is_first_field = problem.quantity == quantity_x.name;
  if (problem.pattern != not_a_number || !is_first_field) return text;
  AtomFormat format = format_of_records(rest);
  if (format == AtomFormat::pdb && input_suffix(std::string(name)) == ".pqr")
    format = AtomFormat::pqr;
  if (format == AtomFormat::pdb)
    text += "; this looks like a PDB file; read it with --format pdb";
  else if (format == AtomFormat::pqr)
    text += "; this looks like a PQR file; read it with --format pqr";
  else if (is_pqr_record(line))
    text += "; this looks like a PDB or PQR file; read it with --format pdb or --format pqr";
  return text;
}

// -------------------------------------------------------------------- waters and models of PQR
// files

// Names of water in the PDB, in force fields, and in files of GROMACS. Other names of water in
// programs of molecular dynamics are names of ligands in the PDB.
constexpr std::string_view water_residues = "HOH WAT H2O DOD SOL TIP2 TIP3 TIP4 TIP5 SPCE";

/// Returns the diagnostic of a kind, which may be new. Diagnostics are in the order of their kinds.
Diagnostic& diagnostic_of(DiagnosticKind kind, AtomFile& file) {
  auto at = std::find_if(file.diagnostics.begin(), file.diagnostics.end(),
                         [kind](const Diagnostic& other) { return other.kind >= kind; });
  if (at == file.diagnostics.end() || at->kind != kind)
    at = file.diagnostics.insert(at, {kind, 0, {}});
  return *at;
}

/// Adds the last atom of a PQR file to the diagnostics if it belongs to water.
void inspect_residue(std::string_view residue, AtomFile& file) {
  if (!has_word(water_residues, upper_case(std::string(residue)))) return;
  Diagnostic& water = diagnostic_of(DiagnosticKind::water, file);
  const auto atom = static_cast<AtomIndex>(file.atoms.size() - 1);
  if (++water.count <= Diagnostic::max_examples) water.examples.push_back({atom, atom});
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
  if (!parse_integer(field, model))
    fail_at_line(name, number,
                 formatted("expected the number of the model, found {}", quoted(field)));
  return model;
}

// ------------------------------------------------------------------------------------------ text

constexpr bool is_control(char c) {
  // Bitwise operators, because compilers do not vectorize short-circuit evaluation.
  const auto byte = static_cast<unsigned char>(c);
  return ((byte < 0x20) & (c != '\t') & (c != '\n') & (c != '\r')) | (byte == 0x7f);
}

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
  fail_at_line(name, first_line + line,
               formatted("control character \\x{:02x}; this looks like a binary file, not text",
                         static_cast<unsigned>(*culprit)));
}

void check_line(std::string_view line, std::string_view name, std::size_t number) {
  // A file with CR line ends would otherwise be read as one line, with one atom and extra columns.
  if (line.find('\r') != std::string_view::npos) {
    fail_at_line(name, number, "carriage return inside the line; expected LF or CRLF line ends");
  }
  if (line.size() > max_line_length) {
    fail_at_line(name, number, formatted("more than {} characters in the line", max_line_length));
  }
}

/// Reads a line of a PQR file that is not a record of an atom. Throws Error if remarks name columns
/// in another order than that of PQR files.
void inspect_other_line(std::string_view line, const AtomLines& lines, std::uint64_t number,
                        LinesRead& read, AtomFile& result) {
  read.columns.add(line);
  if (read.columns.are_swapped())
    fail_at_line(lines.name, number,
                 "the remarks name the column of the radius before that of the charge; PQR files "
                 "have x y z charge radius; swap the columns");
  if (is_unread_atom(line)) add_unread_record(number, result);
}

/// Parses whole lines, which follow the lines of `read`.
void parse_lines(std::string_view text, const AtomLines& lines, LinesRead& read, AtomFile& result) {
  const std::string_view name = lines.name;
  if (read.lines == 0) text = checked_text(text, name, lines.options.format, lines.is_chosen);
  check_is_text(text, name, read.lines + 1);
  const bool is_pqr = lines.options.format == AtomFormat::pqr;
  const int model = lines.options.structure.model;
  const auto is_record = is_pqr ? is_pqr_record : is_xyzr_record;
  const auto parse_line = is_pqr ? parse_pqr : parse_xyzr;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    const std::uint64_t number = ++read.lines;
    check_line(line, name, number);
    if (is_pqr && is_model_record(line)) {
      ++read.models;
      read.last_model = model_number(line, name, number);
    }
    if (is_pqr && !is_record(line)) inspect_other_line(line, lines, number, read, result);
    if (!is_record(line) || (is_pqr && model != 0 && read.last_model != model)) continue;
    Record record;
    if (const Problem problem = parse_line(line, record)) {
      const std::string_view rest(
          line.data(), static_cast<std::size_t>(text.data() + text.size() - line.data()));
      fail_at_line(name, number,
                   is_pqr ? describe_pqr(problem, line) : describe_xyzr(problem, line, rest, name));
    }
    if (result.atoms.size() == max_atoms_of_file)
      fail_at_line(name, number, formatted("more than {} atoms", max_atoms_of_file));
    result.atoms.push_back(record.atom);
    result.lines.push_back(number);
    if (!is_pqr) continue;
    read.likeness.add(line);
    inspect_residue(record.label.residue, result);
    if (!lines.options.with_labels) continue;
    result.labels.push_back(std::move(record.label));
    result.charges.push_back(record.charge);
  }
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

template <class Value>
void grow(std::size_t added, std::vector<Value>& list) {
  const std::size_t wanted = list.size() + added;
  if (wanted > list.capacity()) list.reserve(std::max(wanted, 2 * list.capacity()));
}

/// Returns an upper bound of the number of atoms. Blank lines are not counted.
std::size_t estimate_atoms(std::string_view text) {
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  return std::min(lines, text.size() / min_atom_line_length + 1);
}

/// Reserves memory for the atoms of a text that begins at `line`. Throws Error if it exceeds the
/// limit.
void make_room(std::string_view text, const AtomLines& lines, const ReadingLimit& limit,
               std::uint64_t line, AtomFile& result) {
  const bool has_labels = lines.options.with_labels && lines.options.format == AtomFormat::pqr;
  const std::uint64_t atom_bytes =
      sizeof(Atom) + sizeof(std::uint64_t) + (has_labels ? sizeof(AtomLabel) + sizeof(double) : 0);
  const std::size_t added = estimate_atoms(text), atoms = result.atoms.size();
  const bool is_copied = atoms + added > result.atoms.capacity();
  limit.require(atom_bytes * (is_copied ? atoms + added : added),
                formatted("{}:{}: reading more than {} atoms", lines.name, line, atoms));
  grow(added, result.atoms);
  grow(added, result.lines);
  if (!has_labels) return;
  grow(added, result.labels);
  grow(added, result.charges);
}

/// Throws Error if a file has no atoms, has several models of which none was chosen, or is a PDB
/// file.
void require_atoms(const AtomLines& lines, std::uint64_t atoms, const LinesRead& read) {
  if (atoms == 0)
    throw Error(no_atoms_message(lines.name, lines.options.format, read.lines,
                                 lines.options.structure.model));
  if (lines.options.structure.model == 0 && read.models > 1)
    throw Error(
        formatted("{}: {} models, whose atoms lie on top of each other; choose one with --model N",
                  lines.name, read.models));
  if (!lines.is_chosen && !read.columns.are_known())
    refuse_pdb_records(lines.name, atoms, read.likeness);
}

}  // namespace

AtomFile read_all_atoms(const ReadText& read, const AtomLines& lines, const NameStore& store) {
  AtomFile file;
  LinesRead counts;
  const ReadingLimit limit(lines.options.max_memory);
  for_whole_lines(read, [&](std::string_view text) {
    make_room(text, lines, limit, counts.lines + 1, file);
    parse_lines(text, lines, counts, file);
    if (lines.options.check) lines.options.check();
    if (store.with_atoms) complete_elements(file.labels);
    if (store.is_used()) store.take(file);
  });
  require_atoms(lines, file.atoms.size(), counts);
  complete_elements(file.labels);
  return file;
}

ReadText text_in_memory(std::string_view text) {
  return [text](std::span<char> buffer) mutable {
    const std::size_t count = text.copy(buffer.data(), buffer.size());
    text.remove_prefix(count);
    return count;
  };
}

void add_unread_record(std::uint64_t line, AtomFile& file) {
  Diagnostic& unread = diagnostic_of(DiagnosticKind::unread_record, file);
  if (++unread.count <= Diagnostic::max_examples) unread.examples.push_back({0, 0, line});
}

std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model) {
  const bool has_records = format == AtomFormat::pqr || format == AtomFormat::pdb;
  return formatted("{}: no {} found{}; {} {} read", name,
                   has_records ? "ATOM or HETATM records" : "atoms",
                   model == 0 ? "" : formatted(" in model {} (--model)", model), lines,
                   lines == 1 ? "line" : "lines");
}

}  // namespace eses::detail
