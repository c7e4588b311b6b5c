// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "input/pdb_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <gemmi/pdb.hpp>
#include <gemmi/resinfo.hpp>
#include <iterator>
#include <map>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "eses/error.hpp"
#include "input/atom_reader.hpp"
#include "input/messages.hpp"
#include "input/pdb_elements.hpp"
#include "input/pqr_records.hpp"
#include "input/split_residues.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// ------------------------------------------------------------------------------ fields of records

/// Columns of a record, from 0.
struct Columns {
  std::size_t first, width;
};

// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
constexpr Columns serial_columns{6, 5}, name_columns{12, 4}, residue_columns{17, 3};
constexpr Columns chain_columns{20, 2}, occupancy_columns{54, 6}, element_columns{76, 2};
constexpr std::array<Columns, 3> coordinate_columns{{{30, 8}, {38, 8}, {46, 8}}};
constexpr std::size_t charge_column = 78, record_width = 80;

/// Returns the text of a field without blanks around it. The record may be too short.
std::string_view field_of(std::string_view record, const Columns& columns) {
  return column_text(record, columns.first, columns.width);
}

/// Returns the type of a record in lower case.
std::string type_of(std::string_view record) {
  return lower_case(std::string(without_trailing_blanks(record.substr(0, 6))));
}

/// Looks at four characters, as gemmi does, because records of more than 99999 atoms may have a
/// serial number in the sixth column.
bool is_atom_record(std::string_view record) {
  return starts_with_ignoring_case(record, "atom") || starts_with_ignoring_case(record, "heta");
}

// https://www.wwpdb.org/documentation/file-format-content/format33/remarks1.html#REMARK%20350
bool is_assembly_record(std::string_view record) {
  return starts_with_ignoring_case(record, "remark 350");
}

/// Returns whether this is the type of a MODEL record, whose number may follow without a blank.
bool is_model_type(std::string_view type) {
  return type.starts_with("model") && (type.size() == 5 || is_digit(type[5]));
}

bool has_element(std::string_view record) {
  const std::string_view field = field_of(record, element_columns);
  return record.size() > element_columns.first + 1 &&
         std::any_of(field.begin(), field.end(), is_letter);
}

// Residue names of four letters in GROMACS and CHARMM that begin with the name of an amino acid,
// and names of water.
constexpr std::array<std::string_view, 23> long_residues{
    "ARGN", "ASPH", "ASPP", "CYS2", "CYSD", "CYSH", "GLUH", "GLUP", "HIS1", "HIS2", "HISA", "HISB",
    "HISD", "HISE", "HISH", "LYSH", "LYSN", "TYRH", "TIP3", "TIP4", "TIP5", "SPCE", "TIP2"};

/// Returns whether the four columns after the atom name are a residue name of four letters by
/// itself, such as NALA or TIP3, whatever the names of chains.
bool is_known_long_residue(std::string_view name) {
  return name.size() == 4 &&
         (is_polymer_residue(name) ||
          std::find(long_residues.begin(), long_residues.end(), name) != long_residues.end());
}

/// Returns the four columns after the atom name if all of them are filled.
std::string_view long_residue_of(std::string_view record) {
  const std::string_view name =
      field_of(record, {residue_columns.first, residue_columns.width + 1});
  return name.size() > residue_columns.width && name.find(' ') == name.npos ? name
                                                                            : std::string_view();
}

// ------------------------------------------------------------------------------------------ lines

/// The lines of a PDB text, with their numbers.
class PdbLines {
 public:
  PdbLines(std::string_view text, std::string_view name, Checker& checker)
      : rest_(text),
        name_(name),
        checker_(checker),
        padding_size_(text.size() - (text.find_last_not_of(padding) + 1)) {}

  /// Returns the next line without its end, or nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    checker_.count();
    ++number_;
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
  Checker& checker_;
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
};

PdbLayout layout_of(PdbLines lines) {
  PdbLayout layout;
  while (const std::optional<std::string_view> record = lines.next()) {
    if (!is_atom_record(*record)) continue;
    const std::string_view residue = field_of(*record, residue_columns);
    const bool is_polymer = is_polymer_residue(residue), is_water = is_water_name(residue);
    const bool has_fourth_column = !field_of(*record, {chain_columns.first, 1}).empty();
    if ((is_polymer || is_water) && has_fourth_column &&
        !is_known_long_residue(long_residue_of(*record)))
      layout.has_long_chain_names = true;
    const bool is_ligand =
        !is_polymer && !is_water && !is_ion(field_of(*record, name_columns), residue);
    if (is_ligand && !has_element(*record) && record->substr(0, 13).ends_with(' '))
      layout.is_left_aligned = false;
  }
  return layout;
}

// ---------------------------------------------------------------------------------------- records

/// An input stream of gemmi with the records of a PDB text that matter here, in the columns and
/// the order that gemmi expects. Replaces the serial numbers of atoms by their line numbers.
/// Checks coordinates, because gemmi reads invalid numbers as 0.
class PdbRecords {
 public:
  PdbRecords(PdbLines lines, bool needs_assemblies)
      : lines_(lines), all_lines_(lines), needs_assemblies_(needs_assemblies) {}

  const PdbLines& lines() const { return lines_; }
  bool has_atoms() const { return has_atoms_; }

  // The interface of gemmi's streams; the functions are like the functions of <cstdio>. All records
  // end with a line feed within the buffer, so there is nothing left for getc().
  char* gets(char* buffer, int size) {
    record_ = std::span(buffer, static_cast<std::size_t>(size));
    if (has_pending_model_) return write_pending_model();
    while (const std::optional<std::string_view> line = lines_.next()) {
      check_characters(*line);
      if (is_atom_record(*line)) return write_atom(*line);
      if (is_assembly_record(*line)) return write_operator(*line);
      const std::string type = type_of(*line);
      if (is_model_type(type)) return write_model(*line);
      if (type == "endmdl") is_in_model_ = false;
      const bool has_other_format = type.starts_with("data_") || type.starts_with('{');
      if (type == "endmdl" || type == "end" || type == "ter" || has_other_format)
        return write(*line);
    }
    return nullptr;
  }

  static int getc() { return EOF; }

  /// Reads the lines after the record at which gemmi stops. Throws Error if there are atoms.
  void refuse_further_atoms() {
    const std::uint64_t last_line = lines_.number();
    while (const std::optional<std::string_view> line = lines_.next())
      if (is_atom_record(*line))
        fail_at_line(
            lines_.name(), last_line,
            "atoms follow an END record; remove the record, or put each model between MODEL and "
            "ENDMDL, without END");
  }

  /// Throws Error if the last operator lacks rows.
  void require_whole_operator() const {
    if (operator_rows_ != 0)
      lines_.fail(formatted("expected the record BIOMT{} of an operator", operator_rows_ + 1));
  }

  /// Gives models and residues the names that gemmi cannot read.
  void restore_names(gemmi::Structure& structure) const {
    for (std::size_t i = 0; i < structure.models.size(); ++i) {
      structure.models[i].name = std::to_string(model_numbers_.at(i));
      if (residue_names_.empty()) continue;
      for (gemmi::Chain& chain : structure.models[i].chains)
        for (gemmi::Residue& residue : chain.residues) restore_name(residue);
    }
  }

 private:
  void check_characters(std::string_view line) const {
    if (line.find('\0') != line.npos)
      lines_.fail("the line has a NUL character; the file seems to be damaged");
    if (line.find('\r') != line.npos)
      lines_.fail("carriage return inside the line; expected LF or CRLF line ends");
  }

  // A tab stands for several columns, so that the fields after it are not in theirs.
  void check_columns(std::string_view line) const {
    if (const std::size_t tab = without_trailing_blanks(line).substr(0, charge_column).find('\t');
        tab != line.npos)
      lines_.fail(formatted(
          "tab in column {}; fields of PDB records have fixed columns; replace the tabs by blanks",
          tab + 1));
  }

  // Writes a record with all its columns, as gemmi would otherwise read the rest of an earlier one.
  char* write(std::string_view record) {
    std::memset(record_.data(), ' ', record_width);
    std::memcpy(record_.data(), record.data(), std::min(record.size(), record_width));
    record_[record_width] = '\n';
    record_[record_width + 1] = '\0';
    return record_.data();
  }

  void write_field(const Columns& columns, std::string_view text) {
    std::memset(&record_[columns.first], ' ', columns.width);
    std::memcpy(&record_[columns.first + columns.width - text.size()], text.data(), text.size());
  }

  // ---------------------------------------------------------------------------------------- atoms

  char* write_atom(std::string_view line) {
    check_columns(line);
    constexpr std::size_t end_of_coordinates =
        coordinate_columns.back().first + coordinate_columns.back().width;
    if (line.size() < end_of_coordinates)
      lines_.fail("the record ends before its coordinates; the file seems to be damaged");
    for (std::size_t axis = 0; axis < 3; ++axis)
      check_number(line, coordinate_columns[axis], std::string_view("xyz").substr(axis, 1));
    require_whole_operator();
    // gemmi begins a model at an atom outside of models, too.
    if (!is_in_model_) begin_model(std::nullopt);
    has_atoms_ = true;
    // The charges are not used: old files have line numbers in these columns.
    write(line.substr(0, charge_column));
    write_line_number();
    if (field_of(line, occupancy_columns).empty()) write_field(occupancy_columns, "1.00");
    const std::string_view residue = write_residue(line);
    if (!has_element(line))
      write_field(element_columns,
                  element_by_name(line.substr(name_columns.first, name_columns.width), residue,
                                  layout().is_left_aligned));
    return record_.data();
  }

  // Removes the fourth letter of a residue name, which gemmi would read as a part of the chain
  // name. Returns the residue name.
  std::string_view write_residue(std::string_view line) {
    const std::string_view long_name = long_residue_of(line);
    const bool is_long = !long_name.empty() && is_long_residue(long_name);
    if (is_long) record_[chain_columns.first] = ' ';
    const std::string_view change = is_long ? long_name : std::string_view();
    if (residue_names_.empty() ? is_long : residue_names_.rbegin()->second != change)
      residue_names_.emplace_hint(residue_names_.end(), lines_.number(), change);
    return is_long ? long_name : field_of(line, residue_columns);
  }

  bool is_long_residue(std::string_view name) {
    const std::string_view start = name.substr(0, residue_columns.width);
    const bool is_known =
        is_polymer_residue(start) || gemmi::find_tabulated_residue(std::string(start)).found();
    return (is_known_long_residue(name) || !is_known) && !layout().has_long_chain_names;
  }

  void restore_name(gemmi::Residue& residue) const {
    const auto line = static_cast<std::uint64_t>(residue.atoms.front().serial);
    const auto next = residue_names_.upper_bound(line);
    if (next == residue_names_.begin()) return;
    const std::string& name = std::prev(next)->second;
    if (!name.empty()) residue.name = name;
  }

  const PdbLayout& layout() {
    if (!layout_) layout_ = layout_of(all_lines_);
    return *layout_;
  }

  void check_number(std::string_view line, const Columns& columns, std::string_view what) const {
    const std::string_view field = field_of(line, columns);
    double value = 0;
    if (parse_number(field, value) != std::errc{} || !std::isfinite(value))
      lines_.fail(formatted("expected a number for {} in columns {} to {}, found {}", what,
                            columns.first + 1, columns.first + columns.width, quoted(field)));
  }

  // Writes the line number as five digits or, from 100000 on, as a hybrid-36 number, which gemmi
  // can read: http://cci.lbl.gov/hybrid_36
  void write_line_number() {
    constexpr std::uint64_t first_hybrid = 100000, hybrid_offset = 16796160, hybrid_end = 60466176;
    std::uint64_t number = lines_.number();
    const unsigned base = number < first_hybrid ? 10 : 36;
    if (number >= first_hybrid) number += hybrid_offset - first_hybrid;
    if (number >= hybrid_end) lines_.fail("too many lines for a PDB file");
    for (std::size_t digit = serial_columns.width; digit-- > 0; number /= base)
      record_[serial_columns.first + digit] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % base];
  }

  // ------------------------------------------------------------------------ models and assemblies

  // Begins a model with the number in the field, or with its ordinal number if there is none.
  void begin_model(const std::optional<std::string_view>& field) {
    constexpr std::size_t max_models = 9999;
    if (model_numbers_.size() == max_models)
      lines_.fail(formatted("more than {} models; split the file", max_models));
    int number = static_cast<int>(model_numbers_.size()) + 1;
    if (field && !field->empty()) {
      const char* const end = field->data() + field->size();
      const auto [rest, fault] = std::from_chars(field->data(), end, number);
      if (fault != std::errc{} || rest != end)
        lines_.fail(formatted("expected the number of the model, found {}", quoted(*field)));
    }
    if (std::find(model_numbers_.begin(), model_numbers_.end(), number) != model_numbers_.end())
      lines_.fail(formatted("there are two models {}; give them different numbers", number));
    model_numbers_.push_back(number);
    is_in_model_ = true;
  }

  // Ends the previous model, as some programs do not write its end.
  char* write_model(std::string_view line) {
    const bool has_open_model = is_in_model_;
    line.remove_prefix(std::string_view("model").size());
    begin_model(take_first(line));
    has_pending_model_ = has_open_model;
    return has_open_model ? write("ENDMDL") : write_pending_model();
  }

  // Writes the ordinal number, as gemmi reads only four digits.
  char* write_pending_model() {
    has_pending_model_ = false;
    return write(formatted("MODEL     {:4}", model_numbers_.size()));
  }

  // gemmi would read invalid numbers as 0, and take missing rows from the identity.
  char* write_operator(std::string_view line) {
    if (needs_assemblies_) check_operator(line);
    return write(line);
  }

  void check_operator(std::string_view line) {
    constexpr std::size_t type_column = 11, width = 10;
    constexpr std::string_view type = "  BIOMT";
    if (line.size() > type_column && line.substr(type_column).starts_with(type)) {
      check_columns(line);
      const std::string_view row = line.substr(type_column + type.size()).substr(0, 1);
      if (row != std::to_string(operator_rows_ + 1))
        lines_.fail(formatted("expected the record BIOMT{} of an operator, found BIOMT{}",
                              operator_rows_ + 1, printable(row)));
      const std::string_view number = field_of(line, {19, 4});
      if (operator_rows_ == 0) operator_number_ = number;
      if (number != operator_number_)
        lines_.fail(formatted("expected a row of operator {}, found one of operator {}",
                              printable(operator_number_), printable(number)));
      for (const std::size_t column : std::array<std::size_t, 4>{23, 33, 43, 58})
        check_number(line, {column, width}, "the operator");
      operator_rows_ = (operator_rows_ + 1) % 3;
    } else {
      require_whole_operator();
    }
  }

  PdbLines lines_, all_lines_;
  bool needs_assemblies_;
  std::span<char> record_;  // gemmi's buffer
  bool has_atoms_ = false, is_in_model_ = false, has_pending_model_ = false;
  int operator_rows_ = 0;  // number of rows of an unfinished operator
  std::string_view operator_number_;
  std::vector<int> model_numbers_;
  // Residue names of four letters by the lines from which on they hold; empty if gemmi reads the
  // name.
  std::map<std::uint64_t, std::string> residue_names_;
  std::optional<PdbLayout> layout_;
};

}  // namespace

gemmi::Structure parse_pdb_text(std::string_view text, std::string_view name, bool needs_assemblies,
                                Checker& checker) {
  PdbRecords records(PdbLines(text, name, checker), needs_assemblies);
  try {
    gemmi::Structure structure =
        gemmi::pdb_impl::read_pdb_from_stream(records, std::string(name), gemmi::PdbReadOptions());
    records.require_whole_operator();
    records.refuse_further_atoms();
    if (!records.has_atoms())
      throw Error(no_atoms_message(name, AtomFormat::pdb, records.lines().number()));
    split_residues(structure);
    records.restore_names(structure);
    return structure;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    records.lines().fail(reworded(error.what()));
  }
}

}  // namespace eses::detail
