// This file is valid C++17, for the reason given in mmcif_text.cpp.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <gemmi/numb.hpp>
#include <gemmi/resinfo.hpp>
#include <initializer_list>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "input/check_at.hpp"
#include "input/element_symbols.hpp"
#include "input/structure/mmcif_tables.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

/// The index of a row of the table of atoms, and its line.
struct Row {
  int index;
  std::uint64_t line;
};

/// A column of the table of atoms. All values of a missing column are unknown.
class Column {
 public:
  /// Finds the first of these columns that the table has. If it has none, throws MmcifError with
  /// the name `required`, unless this is empty.
  Column(gemmi::cif::Block& block, std::initializer_list<const char*> names,
         const std::string& required = "") {
    for (const char* const name : names) {
      tag_ = std::string(atom_category) + name;
      values_ = block.find_values(tag_);
      if (values_) return;
    }
    if (!required.empty()) throw MmcifError{0, "the _atom_site table lacks the column " + required};
  }

  int length() const { return values_.length(); }

  /// Returns the value without quotation marks; empty if it is unknown, which files write as `.` or
  /// `?`.
  std::string text(const Row& row) const {
    return values_ ? gemmi::cif::as_string(values_[row.index]) : std::string();
  }

  std::string character(const Row& row, const char* quantity) const {
    std::string value = text(row);
    if (value.size() > 1) fail(row, std::string("one character for ") + quantity);
    return value;
  }

  std::string number(const Row& row, const char* quantity, const char* unknown = "") const {
    std::string value = text(row);
    if (value.empty()) value = unknown;
    if (!std::isfinite(gemmi::cif::as_number(value)))
      fail(row, std::string("a number for ") + quantity);
    return value;
  }

  /// Throws MmcifError if the value, or its part `number`, is not a residue number.
  void check_residue_number(const Row& row, const std::string& number) const {
    constexpr std::ptrdiff_t max_digits = 9;  // such that it is in the range of int
    try {
      gemmi::cif::as_int(number);
      if (std::count_if(number.begin(), number.end(), is_digit) <= max_digits) return;
    } catch (const std::invalid_argument&) {  // The message below has the line.
    }
    fail(row,
         "an integer of at most " + std::to_string(max_digits) + " digits for the residue number");
  }

  [[noreturn]] void fail(const Row& row, const std::string& expected) const {
    throw MmcifError{row.line, "expected " + expected + " in " + tag_ + ", found " +
                                   detail::quoted(values_[row.index])};
  }

 private:
  mutable gemmi::cif::Column values_;  // in gemmi 0.5 no access to values is const
  std::string tag_;
};

/// Returns whether the residue is a standard amino acid or nucleotide, as in ATOM records.
bool is_standard_monomer(const std::string& residue_name) {
  const auto& info = gemmi::find_tabulated_residue(residue_name);
  return info.is_standard() && (info.is_amino_acid() || info.is_nucleic_acid());
}

/// The values of a row that identify a residue in its model.
struct ResidueKey {
  std::string chain, name, number, insertion_code;

  bool operator==(const ResidueKey& other) const {
    return number == other.number && chain == other.chain && name == other.name &&
           insertion_code == other.insertion_code;
  }
};

/// Checks the rows and adds those of the chosen model to a new table.
class TableBuilder {
 public:
  TableBuilder(gemmi::cif::Block& block, ModelList& models) : block_(block), models_(models) {}

  AtomTable build(const std::vector<std::uint64_t>& lines, const CheckCallback& check) {
    AtomTable table;
    gemmi::cif::Loop& loop = table.block.init_loop(
        atom_category,
        {"id", "group_PDB", "type_symbol", "label_atom_id", "label_alt_id", "label_comp_id",
         "label_asym_id", "label_entity_id", "label_seq_id", "pdbx_PDB_ins_code", "Cartn_x",
         "Cartn_y", "Cartn_z", "occupancy", "B_iso_or_equiv", "auth_seq_id", "auth_asym_id"});
    loop.values.reserve(lines.size() * loop.width());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      check_at(i, check);
      const Row row{static_cast<int>(i), lines[i]};
      ResidueKey residue = residue_of(row);
      std::array<std::string, 17> values = values_of(row, residue);
      if (!is_in_chosen_model(row)) continue;
      if (residue.number.empty()) number_residue(row, lines, residue, values);
      if (element_.text(row).empty()) table.guessed_elements.push_back(row.line);
      if (table.chains.empty() || !(residue == last_residue_)) {
        table.chains.push_back(residue.chain);
        last_residue_ = residue;
      }
      values.back() = std::to_string(table.chains.size());
      std::move(values.begin(), values.end(), std::back_inserter(loop.values));
    }
    return table;
  }

 private:
  bool is_in_chosen_model(const Row& row) {
    std::string name = model_number_.text(row);
    if (name.empty()) name = "1";
    if (name == last_model_) return is_chosen_;
    const std::vector<std::string>& known = models_.names;
    is_chosen_ = std::find(known.begin(), known.end(), name) == known.end()
                     ? models_.add(name)
                     : name == models_.chosen;
    last_model_ = name;
    return is_chosen_;
  }

  ResidueKey residue_of(const Row& row) const {
    ResidueKey key{chain_name_.text(row), residue_name_.text(row), number_.text(row),
                   insertion_code_.character(row, "the insertion code")};
    if (key.number.empty()) return key;
    // Old files write the insertion code also after the number, as in 15A.
    if (is_letter(key.number.back())) {
      if (!key.insertion_code.empty() && key.insertion_code[0] != key.number.back())
        number_.fail(row, "the insertion code " + key.insertion_code);
      key.insertion_code = key.number.back();
      key.number.pop_back();
    }
    number_.check_residue_number(row, key.number);
    return key;
  }

  // Gives a residue without a number, such as a water or an ion, a number behind all numbers of the
  // file. A new residue begins with another name or chain, or with an atom that repeats.
  void number_residue(const Row& row, const std::vector<std::uint64_t>& lines, ResidueKey& residue,
                      std::array<std::string, 17>& values) {
    if (last_number_ == 0)
      for (std::size_t i = 0; i < lines.size(); ++i)
        if (const auto other = residue_of({static_cast<int>(i), lines[i]}); !other.number.empty())
          last_number_ = std::max(last_number_, std::stoi(other.number));
    const std::string name = atom_name_.text(row), altloc = altloc_.text(row);
    std::set<std::string>& known = unnumbered_altlocs_[name];
    const bool is_other = residue.chain != unnumbered_.chain || residue.name != unnumbered_.name;
    // An atom has one location without a letter, or several with letters.
    if (is_other || known.count(altloc) > 0 ||
        (!known.empty() && (altloc.empty() || known.count(std::string()) > 0))) {
      ++last_number_;
      unnumbered_altlocs_.clear();
    }
    unnumbered_ = residue;
    unnumbered_altlocs_[name].insert(altloc);
    residue.number = values[auth_number_index] = std::to_string(last_number_);
  }

  std::array<std::string, 17> values_of(const Row& row, const ResidueKey& residue) const {
    const auto quoted = [](const std::string& text) {
      return text.empty() ? std::string("?") : gemmi::cif::quote(text);
    };
    const std::string label_number = label_number_.text(row);
    std::string element = element_.text(row);
    if (element.empty()) element = symbol_by_name(atom_name_.text(row), residue.name);
    if (!label_number.empty()) label_number_.check_residue_number(row, label_number);
    return {std::to_string(row.line),
            is_hetatm(row, residue.name) ? "HETATM" : "ATOM",
            quoted(element),
            quoted(atom_name_.text(row)),
            quoted(altloc_.character(row, "the alternate location")),
            quoted(residue.name),
            quoted(subchain_.text(row)),
            quoted(entity_.text(row)),
            quoted(label_number),
            quoted(residue.insertion_code),
            x_.number(row, "x"),
            y_.number(row, "y"),
            z_.number(row, "z"),
            occupancy_.number(row, "the occupancy", "1"),
            b_factor_.number(row, "the B-factor", "0"),
            quoted(residue.number),
            {}};
  }

  bool is_hetatm(const Row& row, const std::string& residue_name) const {
    const std::string group = group_.text(row);
    return group.empty() ? !is_standard_monomer(residue_name) : lower_case(group.front()) == 'h';
  }

  gemmi::cif::Block& block_;
  ModelList& models_;
  // The required columns come first, in the order in which they are reported.
  Column element_{block_, {"type_symbol"}, "type_symbol"};
  Column atom_name_{block_, {"auth_atom_id", "label_atom_id"}, "label_atom_id"};
  Column residue_name_{block_, {"auth_comp_id", "label_comp_id"}, "label_comp_id"};
  Column x_{block_, {"Cartn_x"}, "Cartn_x"};
  Column y_{block_, {"Cartn_y"}, "Cartn_y"};
  Column z_{block_, {"Cartn_z"}, "Cartn_z"};
  Column number_{block_, {"auth_seq_id", "label_seq_id"}, "auth_seq_id"};
  Column group_{block_, {"group_PDB"}};
  Column altloc_{block_, {"label_alt_id"}};
  Column chain_name_{block_, {"auth_asym_id", "label_asym_id"}};
  Column subchain_{block_, {"label_asym_id", "auth_asym_id"}};
  Column entity_{block_, {"label_entity_id"}};
  Column label_number_{block_, {"label_seq_id"}};
  Column insertion_code_{block_, {"pdbx_PDB_ins_code"}};
  Column occupancy_{block_, {"occupancy"}};
  Column b_factor_{block_, {"B_iso_or_equiv"}};
  Column model_number_{block_, {"pdbx_PDB_model_num"}};
  static constexpr std::size_t auth_number_index = 15;
  int last_number_ = 0;                                              // of residues without a number
  ResidueKey unnumbered_;                                            // the last of these
  std::map<std::string, std::set<std::string>> unnumbered_altlocs_;  // by names of its atoms
  std::string last_model_;
  bool is_chosen_ = false;
  ResidueKey last_residue_;  // of the last row that was added
};

}  // namespace

AtomTable make_atom_table(gemmi::cif::Block& block, const std::vector<std::uint64_t>& lines,
                          ModelList& models, const CheckCallback& check) {
  return TableBuilder(block, models).build(lines, check);
}

}  // namespace eses::detail
