#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <gemmi/atof.hpp>
#include <gemmi/atox.hpp>
#include <gemmi/pdb.hpp>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "input/atom_reader.hpp"
#include "input/atom_records.hpp"
#include "input/pdb_elements.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/structure/pdb_columns.hpp"
#include "input/structure/structure_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// ------------------------------------------------------------------------------ fields of records

// REMARK 350: https://www.wwpdb.org/documentation/file-format-content/format33/remarks1.html
constexpr std::size_t remark_column = 11;
constexpr std::string_view operator_type = "  BIOMT";

/// Returns the type of a record in lower case.
std::string type_of(std::string_view record) {
  return lower_case(std::string(without_trailing_blanks(record.substr(0, 6))));
}

/// Returns a text of a record in capital letters if the whole record is in small ones.
std::string in_capitals(std::string_view text, std::string_view record) {
  return record[0] < 'a' ? std::string(text) : upper_case(std::string(text));
}

/// Returns whether a record is ATOM or HETATM. Serial numbers of more than 99999 atoms may begin in
/// the fifth or sixth column.
bool is_atom_record(std::string_view record) {
  const auto is_followed = [&](std::size_t length) {
    return record.size() == length || is_blank(record[length]) || is_digit(record[length]);
  };
  return starts_with_ignoring_case(record, "hetatm") ||
         (starts_with_ignoring_case(record, "hetat") && is_followed(5)) ||
         (starts_with_ignoring_case(record, "atom") && is_followed(4));
}

bool is_assembly_record(std::string_view record) {
  return starts_with_ignoring_case(record, "remark 350");
}

/// Returns whether this is the type of a MODEL record, whose number may follow without a blank.
bool is_model_type(std::string_view type) {
  return type.starts_with("model") && (type.size() == 5 || is_digit(type[5]));
}

bool is_known_long(std::string_view name) {
  return is_known_long_residue(name) || (name.size() == 4 && is_polymer_residue(name));
}

/// Returns whether four columns are a residue name, if some names of the file may have four
/// letters.
bool is_long(std::string_view name) {
  const std::string start(name.substr(0, residue_columns.width));
  return is_known_long(name) ||
         !(is_polymer_residue(start) || gemmi::find_tabulated_residue(start).found());
}

/// Returns why the fields of an atom's record may not be in their columns; empty if it is unknown
/// or the record is another one.
std::string_view reason_for_columns(std::string_view record) {
  if (!is_atom_record(record)) return {};
  const auto is_digit_at = [&](std::size_t i) { return i < record.size() && is_digit(record[i]); };
  if (is_digit_at(serial_columns.first + 4) && is_digit_at(serial_columns.first + 5))
    return "; the serial number is too wide and shifts the columns; renumber the atoms";
  // Record, serial number, name, residue, perhaps chain, number, and the coordinates.
  constexpr std::size_t min_fields = 8;
  if (count_fields(record) < min_fields) return {};
  for (std::string_view rest = record; !rest.empty();) {
    double value = 0;
    const std::string_view field = take_first(rest);
    if (field.find('.') == field.npos || parse_number(field, value) != std::errc{}) continue;
    const auto start = static_cast<std::size_t>(field.data() - record.data());
    const auto is_inside = [&](const Columns& columns) {
      return start >= columns.first && start + field.size() <= columns.first + columns.width;
    };
    if (std::any_of(coordinate_columns.begin(), coordinate_columns.end(), is_inside)) return {};
    return "; its fields are separated by blanks, but PDB records have fixed columns";
  }
  return {};
}

/// Returns whether two records belong to the same residue.
bool is_same_residue(std::string_view a, std::string_view b) {
  constexpr Columns names{17, 10};
  return field_of(a, names) == field_of(b, names) && segment_of(a) == segment_of(b);
}

// ------------------------------------------------------------------------------------------ lines

/// The lines of a PDB text, with their numbers.
class PdbLines {
 public:
  PdbLines(std::string_view text, std::string_view name, const CheckCallback& check)
      : rest_(text),
        name_(name),
        check_(check),
        padding_size_(text.size() - (text.find_last_not_of(padding) + 1)) {}

  /// Returns the next line without its end, or nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    check_at(++number_, check_);
    std::string_view line = take_line(rest_);
    // NUL characters are accepted as padding at the end of the text.
    if (rest_.size() <= padding_size_)
      while (line.ends_with('\0')) line.remove_suffix(1);
    return line;
  }

  std::uint64_t number() const { return number_; }
  std::string_view name() const { return name_; }

  [[noreturn]] void fail(std::string_view what) const { fail_at_line(name_, number_, what); }

 private:
  static constexpr std::string_view padding{"\0\r\n ", 4};

  std::string_view rest_, name_;
  const CheckCallback& check_;
  std::size_t padding_size_;  // number of characters of padding at the end of the text
  std::uint64_t number_ = 0;
};

bool is_water_name(std::string_view residue) {
  return gemmi::find_tabulated_residue(std::string(residue)).is_water();
}

/// Properties of a whole text on which the meaning of its columns depends.
struct PdbLayout {
  /// Whether the names of all atoms without an element begin in the first column of the name,
  /// although names of one letter belong in the second column. Only ligands count, because a ligand
  /// may be appended to a protein with water and ions.
  bool is_left_aligned = true;
  /// Whether chain names have two letters, the first of which follows the residue name.
  bool has_long_chain_names = false;
  /// Whether the columns of the segment have the elements of all atoms, of two kinds or more.
  bool has_elements_in_segments = false;
};

PdbLayout layout_of(PdbLines lines) {
  PdbLayout layout;
  std::string_view first_segment;
  bool are_elements = true;
  while (const std::optional<std::string_view> record = lines.next()) {
    if (!is_atom_record(*record)) continue;
    if (first_segment.empty()) first_segment = field_of(*record, segment_columns);
    const std::string_view symbol = element_in_segment(*record);
    are_elements = are_elements && !symbol.empty();
    if (symbol != first_segment) layout.has_elements_in_segments = true;
    const std::string_view residue = field_of(*record, residue_columns);
    const bool is_polymer = is_polymer_residue(residue), is_water = is_water_name(residue);
    const bool has_fourth_column = !field_of(*record, {chain_columns.first, 1}).empty();
    if ((is_polymer || is_water) && has_fourth_column &&
        !is_known_long(field_of(*record, {residue_columns.first, residue_columns.width + 1})))
      layout.has_long_chain_names = true;
    const bool is_ligand =
        !is_polymer && !is_water && !is_ion({field_of(*record, name_columns), residue});
    if (is_ligand && element_of_columns(*record).empty() && record->substr(0, 13).ends_with(' '))
      layout.is_left_aligned = false;
  }
  layout.has_elements_in_segments = layout.has_elements_in_segments && are_elements;
  return layout;
}

// ---------------------------------------------------------------------------------------- records

/// Returns the residue number and insertion code in the five columns of a record. Numbers above
/// 9999 are in hybrid-36 (http://cci.lbl.gov/hybrid_36).
gemmi::SeqId number_in_columns(std::string_view columns) {
  constexpr int first_hybrid = 10000, first_in_base_36 = 10 * 36 * 36 * 36;
  const std::string text(without_leading_blanks(columns.substr(0, 4)));
  gemmi::SeqId id;
  id.icode = columns[4];
  if (columns[0] >= 'A')
    id.num =
        static_cast<int>(std::strtol(text.c_str(), nullptr, 36)) - first_in_base_36 + first_hybrid;
  else if (!text.empty())
    id.num = gemmi::string_to_int(text, false);
  return id;
}

/// Returns the number at the start of a field; 0 if there is none.
float number_at_start(std::string_view field) {
  double value = 0;
  gemmi::fast_from_chars(field.data(), field.data() + field.size(), value);
  return static_cast<float>(value);
}

/// Returns the element by the four columns of a name, in which symbols are right-justified in the
/// first two. Names of four letters that begin with H are those of hydrogens, and digits belong to
/// no symbol.
gemmi::Element element_of_name_columns(std::string_view name) {
  if (lower_case(name[0]) == 'h' && name[3] != ' ') return gemmi::El::H;
  if (is_digit(name[0])) return gemmi::Element(std::string{' ', name[1]});
  if (is_digit(name[1])) return gemmi::Element(std::string{' ', name[0]});
  return gemmi::Element(std::string(name));
}

/// Checks the records of a PDB text and makes the chains of the chosen model.
class PdbRecords {
 public:
  PdbRecords(const PdbLines& lines, const ParseOptions& options)
      : lines_(lines),
        all_lines_(lines),
        needs_assemblies_(!options.assembly.empty()),
        needs_occupancies_(options.needs_occupancies) {
    result_.models.wanted = options.model;
  }

  ParsedStructure parse() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      const std::string type = type_of(*line);
      add_record(*line, type);
      if (type == "end") break;
    }
    require_whole_operator();
    refuse_further_atoms();
    if (!has_atoms_) throw Error(no_atoms_message(lines_.name(), AtomFormat::pdb, lines_.number()));
    if (!remarks_.empty()) result_.structure = gemmi::read_pdb_string(remarks_, "");
    for (std::size_t i = 0; i < result_.structure.assemblies.size(); ++i)
      result_.structure.assemblies[i].name = assemblies_.at(i);
    result_.structure.input_format = gemmi::CoorFormat::Pdb;
    result_.structure.models = {make_model()};
    result_.structure.models.front().chains = std::move(chains_.chains);
    result_.sources.shrink_to_fit();
    return std::move(result_);
  }

 private:
  void add_record(std::string_view line, const std::string& type) {
    check_characters(line);
    if (is_atom_record(line)) {
      check_atom(line);
    } else if (is_assembly_record(line)) {
      add_to_assembly(line);
    } else if (is_model_type(type)) {
      line.remove_prefix(std::string_view("model").size());
      begin_model(take_first(line));
    } else if (type == "endmdl") {
      is_in_model_ = false;
    } else if (type == "ter") {
      end_polymer();
    } else {
      if (is_unread_atom(line)) result_.unread_records.push_back(lines_.number());
      if (!is_in_model_) refuse_other_format(line);
    }
  }

  void check_characters(std::string_view line) const {
    if (line.find('\0') != line.npos)
      lines_.fail("the line has a NUL character; the file seems to be damaged");
    if (line.find('\r') != line.npos)
      lines_.fail("carriage return inside the line; expected LF or CRLF line ends");
  }

  // A tab stands for several columns, so that the fields after it are not in theirs.
  void check_columns(std::string_view line) const {
    if (const std::size_t tab = without_trailing_blanks(line).substr(0, end_of_fields).find('\t');
        tab != line.npos)
      lines_.fail(formatted(
          "tab in column {}; fields of PDB records have fixed columns; replace the tabs by blanks",
          tab + 1));
  }

  double number_in(std::string_view line, const Columns& columns, std::string_view what) const {
    const std::string_view field = field_of(line, columns);
    double value = 0;
    if (parse_number(field, value) != std::errc{} || !std::isfinite(value))
      lines_.fail(formatted("expected a number for {} in columns {} to {}, found {}{}", what,
                            columns.first + 1, columns.first + columns.width, quoted(field),
                            reason_for_columns(line)));
    return value;
  }

  void refuse_other_format(std::string_view line) const {
    for (const auto& [start, format] : {std::pair("data_", "cif"), std::pair("{\"data_", "mmJSON")})
      if (starts_with_ignoring_case(line, start))
        lines_.fail(formatted("incorrect file format (perhaps it is {} not pdb?): {}", format,
                              lines_.name()));
  }

  // Reads the lines after an END record. Throws Error if there are atoms.
  void refuse_further_atoms() {
    const std::uint64_t last_line = lines_.number();
    while (const std::optional<std::string_view> line = lines_.next())
      if (is_atom_record(*line))
        fail_at_line(
            lines_.name(), last_line,
            "atoms follow an END record; remove the record, or put each model between MODEL and "
            "ENDMDL, without END");
  }

  // ---------------------------------------------------------------------------------------- atoms

  void check_atom(std::string_view line) {
    check_columns(line);
    if (line.size() < occupancy_columns.first) {
      const std::string_view reason = reason_for_columns(line);
      lines_.fail(formatted("the record ends before its coordinates{}",
                            reason.empty() ? "; the file seems to be damaged" : reason));
    }
    const gemmi::Position position{number_in(line, coordinate_columns[0], "x"),
                                   number_in(line, coordinate_columns[1], "y"),
                                   number_in(line, coordinate_columns[2], "z")};
    require_whole_operator();
    if (!is_in_model_) begin_model({});
    has_atoms_ = true;
    if (is_chosen_) add_atom(line, position);
    previous_ = line;
  }

  void add_atom(std::string_view line, const gemmi::Position& position) {
    // Columns of residue and chain do not overlap for most names.
    const bool may_be_long = !is_blank(line[chain_columns.first]) && !layout().has_long_chain_names;
    const ResidueColumns names = split_residue(line, may_be_long, is_long);
    const bool has_symbol_in_segment = has_element_in_segment(line);
    gemmi::Residue& residue = residue_of(line, names, has_symbol_in_segment);
    gemmi::Atom& atom = residue.atoms.emplace_back();
    atom.serial = static_cast<int>(result_.sources.size());
    atom.name = field_of(line, name_columns);
    atom.altloc = is_blank(line[altloc_column]) ? '\0' : line[altloc_column];
    atom.pos = position;
    const std::string_view occupancy = field_of(line, occupancy_columns);
    atom.occ = needs_occupancies_
                   ? static_cast<float>(number_in(line, occupancy_columns, "the radius"))
               : occupancy.empty() ? 1
                                   : number_at_start(occupancy);
    atom.b_iso = number_at_start(field_of(line, b_factor_columns));
    result_.sources.push_back({static_cast<std::uint32_t>(lines_.number())});
    atom.element =
        element_of(line, names.residue,
                   has_symbol_in_segment ? element_in_segment(line) : element_of_columns(line));
  }

  gemmi::Residue& residue_of(std::string_view line, const ResidueColumns& names,
                             bool has_symbol_in_segment) {
    gemmi::ResidueId id;
    id.seqid = number_in_columns(line.substr(sequence_columns.first, sequence_columns.width));
    if (!has_symbol_in_segment) id.segment = segment_of(line);
    id.name = names.residue;
    return chains_.residue(std::string(names.chain), id, [&](gemmi::Residue& residue) {
      if (chains_.last().residues.size() == 1) is_after_polymer_ = chains_.has_polymer_before();
      residue.het_flag = lower_case(line[0]) == 'h' ? 'H' : 'A';
      if (is_after_polymer_)
        residue.entity_type =
            residue.is_water() ? gemmi::EntityType::Water : gemmi::EntityType::NonPolymer;
    });
  }

  // Returns `given`, the element of the file or, if it has none, that of the names, unless the
  // columns of the name decide. An atom that is named as an ion and alone in its residue is an ion,
  // because programs that derive elements from names write C for calcium, and P for potassium.
  gemmi::Element element_of(std::string_view line, std::string_view residue,
                            std::string_view given) {
    if (is_unknown_element(given) && is_polymer_residue(residue)) given = {};
    const std::string_view columns = line.substr(name_columns.first, name_columns.width);
    const std::string name = in_capitals(columns, line), of = in_capitals(residue, line);
    NamedAtom atom{name, of};
    atom.is_alone = true;
    atom.is_alone = !is_same_residue(previous_, line) && is_ion(atom) && is_last_of_residue(line);
    std::string element(given);
    if (given.empty() || atom.is_alone) {
      atom.is_polymer = is_polymer_residue(residue);
      atom.is_left_aligned = given.empty() && layout().is_left_aligned;
      if (given.empty() || !atom.is_polymer) element = element_by_name(atom);
      result_.sources.back().is_element_by_name =
          lower_case(element) != lower_case(std::string(given)) || given.empty();
    }
    return element.empty() ? element_of_name_columns(columns) : gemmi::Element(element);
  }

  // Returns whether the next atom belongs to another residue.
  bool is_last_of_residue(std::string_view line) const {
    PdbLines following = lines_;
    while (const std::optional<std::string_view> record = following.next())
      if (is_atom_record(*record)) return !is_same_residue(line, *record);
    return true;
  }

  // Few files need the layout for this.
  bool has_element_in_segment(std::string_view line) {
    return !element_in_segment(line).empty() && layout().has_elements_in_segments;
  }

  const PdbLayout& layout() {
    if (!layout_) layout_ = layout_of(all_lines_);
    return *layout_;
  }

  // ------------------------------------------------------------------------------------- models

  // Begins a model with the number in the field, or with its ordinal number if there is none. Some
  // programs do not write the end of the previous model.
  void begin_model(std::string_view field) {
    constexpr std::size_t max_models = 9999;
    ModelList& models = result_.models;
    if (models.names.size() == max_models)
      lines_.fail(formatted("more than {} models; split the file", max_models));
    int number = static_cast<int>(models.names.size()) + 1;
    if (!field.empty() && !parse_integer(field, number))
      lines_.fail(formatted("expected the number of the model, found {}", quoted(field)));
    const std::string name = std::to_string(number);
    if (gemmi::in_vector(name, models.names))
      lines_.fail(formatted("there are two models {}; give them different numbers", number));
    is_in_model_ = true;
    is_chosen_ = models.add(name);
  }

  // The first TER record of a chain ends its polymer. After it, the chain may have ligands and
  // water. Other TER records do not end a polymer.
  void end_polymer() {
    if (!is_in_model_ || !is_chosen_ || chains_.chains.empty()) return;
    if (!ended_chains_.insert(chains_.last().name).second || is_after_polymer_) return;
    for (gemmi::Residue& residue : chains_.last().residues)
      residue.entity_type = gemmi::EntityType::Polymer;
    is_after_polymer_ = true;
  }

  // ------------------------------------------------------------------------------------ assemblies

  // gemmi takes only the first 20 characters of a name, which may be a list of assemblies.
  void add_to_assembly(std::string_view line) {
    if (needs_assemblies_) check_operator(line);
    // gemmi needs all columns.
    std::string record(line.substr(0, record_width));
    record.resize(record_width, ' ');
    constexpr std::string_view key = "BIOMOLECULE:";
    if (std::string_view(record).substr(remark_column).starts_with(key))
      assemblies_.emplace_back(trimmed(line.substr(remark_column + key.size())));
    remarks_.append(record).append(1, '\n');
  }

  // gemmi reads invalid numbers as 0, and takes missing rows from the identity.
  void check_operator(std::string_view line) {
    constexpr std::size_t width = 10;
    if (line.size() <= remark_column || !line.substr(remark_column).starts_with(operator_type)) {
      require_whole_operator();
      return;
    }
    check_columns(line);
    const std::string_view row = line.substr(remark_column + operator_type.size()).substr(0, 1);
    if (row != std::to_string(operator_rows_ + 1))
      lines_.fail(formatted("expected the record BIOMT{} of an operator, found BIOMT{}",
                            operator_rows_ + 1, printable(row)));
    const std::string_view number = field_of(line, {19, 4});
    if (operator_rows_ == 0) operator_number_ = number;
    if (number != operator_number_)
      lines_.fail(formatted("expected a row of operator {}, found one of operator {}",
                            printable(operator_number_), printable(number)));
    for (const std::size_t column : std::array<std::size_t, 4>{23, 33, 43, 58})
      number_in(line, {column, width}, "the operator");
    operator_rows_ = (operator_rows_ + 1) % 3;
  }

  // Throws Error if the last operator lacks rows.
  void require_whole_operator() const {
    if (operator_rows_ != 0)
      lines_.fail(formatted("expected the record BIOMT{} of an operator", operator_rows_ + 1));
  }

  PdbLines lines_, all_lines_;
  bool needs_assemblies_, needs_occupancies_;
  ParsedStructure result_;
  ChainBuilder chains_;
  std::string_view previous_;  // the last record of an atom
  bool has_atoms_ = false, is_in_model_ = false, is_chosen_ = false;
  bool is_after_polymer_ = false;  // whether the polymer of the last chain has ended
  std::set<std::string> ended_chains_;
  std::string remarks_;                  // REMARK 350 for gemmi
  std::vector<std::string> assemblies_;  // names
  int operator_rows_ = 0;                // number of rows of an unfinished operator
  std::string_view operator_number_;
  std::optional<PdbLayout> layout_;
};

}  // namespace

ParsedStructure parse_pdb_text(std::string_view text, std::string_view name,
                               const ParseOptions& options) {
  return PdbRecords(PdbLines(text, name, options.check), options).parse();
}

}  // namespace eses::detail
