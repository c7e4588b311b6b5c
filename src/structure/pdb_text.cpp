// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "structure/pdb_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <gemmi/pdb.hpp>
#include <gemmi/resinfo.hpp>
#include <new>
#include <optional>
#include <string>
#include <system_error>

#include "eses/error.hpp"
#include "io/atom_lines.hpp"
#include "io/text_fields.hpp"
#include "structure/messages.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Names of residues in the force fields of Amber, CHARMM and GROMACS that gemmi does not know:
// protonation states of amino acids, caps of chains, and nucleotides.
constexpr std::array<std::string_view, 62> md_residues{
    "HID", "HIE", "HIP", "HSD", "HSE", "HSP", "HSC", "HIN", "HDP", "CYX", "CYM", "CYN", "CYH",
    "CYP", "CY2", "ASH", "ASB", "GLH", "LYN", "LYP", "ARN", "TYM", "ACE", "NME", "NMA", "NHE",
    "NH2", "FOR", "CT3", "NAL", "A3",  "A5",  "AN",  "C3",  "C5",  "CN",  "G3",  "G5",  "GN",
    "U3",  "U5",  "UN",  "RA",  "RC",  "RG",  "RU",  "RA3", "RA5", "RC3", "RC5", "RG3", "RG5",
    "RU3", "RU5", "DA3", "DA5", "DC3", "DC5", "DG3", "DG5", "DT3", "DT5"};

/// An input stream of gemmi with the lines of a PDB text. Replaces the serial numbers of atoms by
/// their line numbers. Checks coordinates, because gemmi reads invalid numbers as 0.
class PdbLines {
 public:
  PdbLines(std::string_view text, std::string_view name, bool with_assemblies, Checker& checker)
      : rest_(text), name_(name), with_assemblies_(with_assemblies), checker_(checker) {}

  std::uint64_t line() const { return line_; }
  bool has_atoms() const { return has_atoms_; }

  // The interface of gemmi's streams; the functions are like those of <cstdio>.
  char* gets(char* buffer, int size) {
    if (rest_.empty()) return nullptr;
    checker_.count();
    line_start_ = rest_;
    ++line_;
    const std::size_t room = static_cast<std::size_t>(size) - 1;
    const std::size_t end = rest_.substr(0, room).find('\n');
    const std::size_t length = end == rest_.npos ? std::min(room, rest_.size()) : end + 1;
    refuse_nul(length);
    std::memcpy(buffer, rest_.data(), length);
    buffer[length] = '\0';
    rest_.remove_prefix(length);
    const std::string_view record(buffer, length);
    if (is_atom_record(record))
      prepare_atom(buffer, length);
    else if (with_assemblies_ && is_assembly_record(record))
      check_operator(record);
    else if (!is_separator(record))
      hide_record(buffer, length);
    return buffer;
  }

  int getc() {
    if (rest_.empty()) return EOF;
    refuse_nul(1);
    const char c = rest_.front();
    rest_.remove_prefix(1);
    return static_cast<unsigned char>(c);
  }

  /// Reads the rest of the text after the line at which gemmi stops. Throws Error if there are
  /// atoms.
  void refuse_further_atoms() {
    const std::uint64_t last_line = line_;
    while (!rest_.empty()) {
      checker_.count();
      ++line_;
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      if (is_atom_record(rest_.substr(0, end)))
        fail_at_line(
            name_, last_line,
            "atoms follow an END record; remove the record, or separate models by MODEL and "
            "ENDMDL");
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
    }
  }

 private:
  // Throws Error if the next characters contain a NUL, at which gemmi would end the line. NULs are
  // accepted as padding at the end of the text.
  void refuse_nul(std::size_t length) const {
    constexpr std::string_view padding("\0\r\n ", 4);
    const std::size_t nul = rest_.substr(0, length).find('\0');
    if (nul == rest_.npos || rest_.find_first_not_of(padding, nul) == rest_.npos) return;
    fail_at_line(name_, line_, "the line has a NUL character; the file seems to be damaged");
  }

  // Compares four characters and ignores the case, as gemmi does.
  static bool is_atom_record(std::string_view line) {
    const std::string type = lower_case(std::string(line.substr(0, 4)));
    return type == "atom" || type == "heta";
  }

  // https://www.wwpdb.org/documentation/file-format-content/format33/remarks1.html#REMARK%20350
  static bool is_assembly_record(std::string_view line) {
    return lower_case(std::string(line.substr(0, 10))) == "remark 350";
  }

  // Throws Error if a row of an operator has invalid numbers, which gemmi would read as 0.
  void check_operator(std::string_view line) const {
    constexpr std::size_t type_column = 11, width = 10;
    const std::string_view record = without_line_end(line);
    if (record.size() < type_column || !record.substr(type_column).starts_with("  BIOMT")) return;
    for (const std::size_t column : {23, 33, 43, 58})
      check_number(record, column, width, "the operator");
  }

  // Returns whether a record separates chains or models, or tells gemmi that the text has another
  // format.
  static bool is_separator(std::string_view line) {
    constexpr std::array<std::string_view, 5> types{"model", "end", "ter", "data_", "{"};
    const std::string text = lower_case(std::string(line.substr(0, 6)));
    return std::any_of(types.begin(), types.end(),
                       [&](std::string_view type) { return text.starts_with(type); });
  }

  // Replaces the type of a record by blanks. gemmi would refuse faults in records that do not
  // matter here, such as an ANISOU record without its atom.
  static void hide_record(char* buffer, std::size_t length) {
    constexpr std::size_t type_width = 6;
    for (std::size_t i = 0; i < std::min(length, type_width) && buffer[i] != '\n'; ++i)
      buffer[i] = ' ';
  }

  // https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
  static constexpr std::size_t serial_column = 6, serial_width = 5;
  static constexpr std::size_t name_column = 12, name_width = 4;
  static constexpr std::size_t residue_column = 17, residue_width = 3;
  static constexpr std::size_t element_column = 76, charge_column = 78;
  static constexpr std::size_t coordinate_column = 30, coordinate_width = 8;
  static constexpr std::size_t end_of_coordinates = coordinate_column + 3 * coordinate_width;

  void prepare_atom(char* buffer, std::size_t length) {
    const std::string_view record = without_line_end({buffer, length});
    length = record.size();
    has_atoms_ = true;
    if (length < end_of_coordinates)
      fail_at_line(name_, line_,
                   "the record ends before its coordinates; the file seems to be damaged");
    for (std::size_t axis = 0; axis < 3; ++axis)
      check_number(record, coordinate_column + axis * coordinate_width, coordinate_width,
                   std::string_view("xyz").substr(axis, 1));
    write_line_number(buffer + serial_column);
    // Removes the charges, which are not used: old files have line numbers in these columns.
    if (length > charge_column) std::memset(buffer + charge_column, ' ', length - charge_column);
    if (!has_element(record)) write_element(buffer, length);
  }

  static bool has_element(std::string_view record) {
    return record.size() > element_column + 1 &&
           (is_letter(record[element_column]) || is_letter(record[element_column + 1]));
  }

  // Adds a missing element symbol. Otherwise gemmi would derive it from the alignment of the atom
  // name, and read misaligned names such as `CA  ` and `HG  ` in amino acids as calcium and
  // mercury.
  void write_element(char* buffer, std::size_t length) {
    const std::string_view record(buffer, length);
    const std::string_view name = column_text(record, name_column, name_width);
    const std::string_view residue = column_text(record, residue_column, residue_width);
    const std::array<char, 2> element = element_by_name(name, residue);
    if (element[1] == '\0') return;
    for (; length < element_column; ++length) buffer[length] = ' ';
    std::memcpy(buffer + element_column, std::array{element[0], element[1], '\n', '\0'}.data(), 4);
  }

  // Returns the element of an atom by its name, right-justified, or zeros if the name is ambiguous.
  // `HG` in a residue HG is mercury.
  std::array<char, 2> element_by_name(std::string_view name, std::string_view residue) {
    constexpr std::array<char, 2> ambiguous{};
    const bool is_known = is_polymer(residue);
    const bool is_ion = is_known ? name == residue : is_ion_name(name, residue);
    while (!name.empty() && is_digit(name.front())) name.remove_prefix(1);
    if (name.empty() || is_ion || name.starts_with("SE")) return ambiguous;
    const char first = name.front();
    if (first == 'H' || first == 'D') return {' ', first};
    if (!is_known && !is_left_aligned()) return ambiguous;
    // In ligands these names are usually chlorine, bromine and iron.
    const std::string_view stem = name.substr(0, name.find_first_of("0123456789"));
    if (!is_known && (stem == "CL" || stem == "BR" || stem == "FE")) return {stem[0], stem[1]};
    const std::string_view elements = is_known ? "CNOSP" : "CNOSPFIB";
    return elements.find(first) == elements.npos ? ambiguous : std::array{' ', first};
  }

  // Returns whether an atom is the only one of its residue, as in the residues CA, FE2 and 3CO.
  static bool is_ion_name(std::string_view name, std::string_view residue) {
    const auto letters = [](std::string_view text) {
      while (!text.empty() && is_digit(text.front())) text.remove_prefix(1);
      while (!text.empty() && is_digit(text.back())) text.remove_suffix(1);
      return text;
    };
    return !name.empty() && letters(name) == letters(residue);
  }

  static bool is_polymer(std::string_view residue) {
    const gemmi::ResidueInfo& info = gemmi::find_tabulated_residue(std::string(residue));
    if (info.is_amino_acid() || info.is_nucleic_acid()) return true;
    return std::find(md_residues.begin(), md_residues.end(), residue) != md_residues.end();
  }

  // Returns whether the names of all atoms without an element begin in the first column of the
  // name, although names of one letter belong in the second column. Only the residues that are not
  // polymers count, because a ligand may be appended to a protein. Looks at the rest of the text
  // once.
  bool is_left_aligned() {
    if (!is_left_aligned_) is_left_aligned_ = finds_left_aligned_names();
    return *is_left_aligned_;
  }

  bool finds_left_aligned_names() const {
    for (std::string_view text = line_start_; !text.empty();) {
      checker_.count();
      const std::size_t end = std::min(text.find('\n'), text.size());
      const std::string_view record = without_line_end(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      if (!is_atom_record(record) || record.size() < end_of_coordinates || has_element(record))
        continue;
      if (record[name_column] == ' ' &&
          !is_polymer(column_text(record, residue_column, residue_width)))
        return false;
    }
    return true;
  }

  static std::string_view without_line_end(std::string_view line) {
    while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  static std::string_view column_text(std::string_view record, std::size_t first,
                                      std::size_t width) {
    return without_trailing_blanks(without_leading_blanks(record.substr(first, width)));
  }

  void check_number(std::string_view record, std::size_t first, std::size_t width,
                    std::string_view what) const {
    const std::string_view field =
        first < record.size() ? column_text(record, first, width) : std::string_view();
    double value = 0;
    if (parse_number(field, value) != std::errc{} || !std::isfinite(value))
      fail_at_line(name_, line_,
                   formatted("expected a number for {} in columns {} to {}, found {}", what,
                             first + 1, first + width, quoted(field)));
  }

  // Writes the line number as five digits or, from 100000 on, as a hybrid-36 number, which gemmi
  // can read: http://cci.lbl.gov/hybrid_36
  void write_line_number(char* target) const {
    constexpr std::uint64_t first_hybrid = 100000, hybrid_offset = 16796160, hybrid_end = 60466176;
    std::uint64_t number = line_;
    if (number >= first_hybrid) number += hybrid_offset - first_hybrid;
    if (number >= hybrid_end) fail_at_line(name_, line_, "too many lines for a PDB file");
    const unsigned base = line_ < first_hybrid ? 10 : 36;
    for (std::size_t digit = serial_width; digit-- > 0; number /= base)
      target[digit] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % base];
  }

  std::string_view rest_, name_;
  std::string_view line_start_;  // the text from the current line on
  bool with_assemblies_;
  Checker& checker_;
  std::uint64_t line_ = 0;
  bool has_atoms_ = false;
  std::optional<bool> is_left_aligned_;
};

}  // namespace

gemmi::Structure parse_pdb_text(std::string_view text, std::string_view name, bool with_assemblies,
                                Checker& checker) {
  PdbLines lines(text, name, with_assemblies, checker);
  try {
    gemmi::Structure structure =
        gemmi::pdb_impl::read_pdb_from_stream(lines, std::string(name), gemmi::PdbReadOptions());
    lines.refuse_further_atoms();
    if (!lines.has_atoms()) throw Error(no_atoms_message(name, AtomFormat::pdb, lines.line()));
    return structure;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail_at_line(name, lines.line(), reworded(error.what()));
  }
}

}  // namespace eses::detail
