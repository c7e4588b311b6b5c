// This file is valid C++17, for the reason given in mmcif_text.cpp.
//
// gemmi 0.5 also converts this table. It needs quadratic time for long chains, accepts coordinates
// that are not numbers, and reports other faults without a line.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gemmi/numb.hpp>
#include <gemmi/resinfo.hpp>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "input/chain_builder.hpp"
#include "input/check_at.hpp"
#include "input/mmcif_tables.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

using Loop = gemmi::cif::Loop;

/// A row of the table of atoms.
struct Row {
  const std::string* values = nullptr;
  std::uint64_t line = 0;
};

/// A column of the table of atoms. All values of a missing column are unknown.
class Column {
 public:
  /// Finds the first of these columns that the table has. If it has none, throws MmcifError with
  /// the name `required`, unless this is empty.
  Column(const Loop& table, std::initializer_list<const char*> names,
         const std::string& required = "") {
    for (const char* const name : names) {
      tag_ = std::string(atom_category) + name;
      index_ = table.find_tag(tag_);
      if (exists()) return;
    }
    if (!required.empty()) throw MmcifError{0, "the _atom_site table lacks the column " + required};
  }

  bool exists() const { return index_ >= 0; }

  /// Returns the value without quotation marks; empty if it is unknown, which files write as `.` or
  /// `?`.
  std::string text(const Row& row) const {
    return exists() ? gemmi::cif::as_string(row.values[index_]) : std::string();
  }

  char character(const Row& row, const char* quantity, char unknown) const {
    const std::string value = text(row);
    if (value.size() > 1) fail(row, std::string("one character for ") + quantity);
    return value.empty() ? unknown : value.front();
  }

  double number(const Row& row, const char* quantity) const {
    const double value = gemmi::cif::as_number(text(row));
    if (!std::isfinite(value)) fail(row, std::string("a number for ") + quantity);
    return value;
  }

  double number(const Row& row, const char* quantity, double unknown) const {
    return text(row).empty() ? unknown : number(row, quantity);
  }

  /// Converts the value, or its part `number`, to a residue number.
  int residue_number(const Row& row, const std::string& number) const {
    constexpr std::ptrdiff_t max_digits = 9;  // such that it is in the range of int
    try {
      if (std::count_if(number.begin(), number.end(), is_digit) <= max_digits)
        return gemmi::cif::as_int(number);
    } catch (const std::invalid_argument&) {  // The message below has the line.
    }
    fail(row,
         "an integer of at most " + std::to_string(max_digits) + " digits for the residue number");
  }

  [[noreturn]] void fail(const Row& row, const std::string& expected) const {
    throw MmcifError{row.line, "expected " + expected + " in " + tag_ + ", found " +
                                   detail::quoted(row.values[index_])};
  }

 private:
  std::string tag_;
  int index_ = -1;
};

/// Returns whether the residue is a standard amino acid or nucleotide, as in ATOM records.
bool is_standard_monomer(const std::string& residue_name) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(residue_name);
  return info.is_standard() && (info.is_amino_acid() || info.is_nucleic_acid());
}

/// Builds models from the rows of a table.
class ModelBuilder {
 public:
  explicit ModelBuilder(const Loop& table) : table_(table) {}

  void add(const Row& row) {
    choose_chain(row);
    residue_of(row).atoms.push_back(atom_of(row));
  }

  std::vector<gemmi::Model> take_models() { return std::move(models_); }

 private:
  // Begins a new chain where the name of the model or chain changes.
  void choose_chain(const Row& row) {
    const std::string number = model_number_.text(row);
    const std::string model = number.empty() ? std::string("1") : number;
    const std::string chain = chain_name_.text(row);
    if (models_.empty() || model != models_[model_].name) {
      const auto [found, is_new] = model_indices_.emplace(model, models_.size());
      if (is_new) models_.emplace_back(model);
      model_ = found->second;
      chain_.end();
    }
    if (!chain_.is_in(chain)) chain_.begin(models_[model_], chain);
  }

  // Finds or adds the residue of a row in the current chain.
  gemmi::Residue& residue_of(const Row& row) {
    const gemmi::ResidueId id{sequence_id_of(row), {}, residue_name_.text(row)};
    const std::string label_number = label_number_.text(row);
    const gemmi::Residue::OptionalNum label_seq =
        label_number.empty() ? gemmi::Residue::OptionalNum()
                             : label_number_.residue_number(row, label_number);
    gemmi::Residue& residue = chain_.residue(id);
    if (residue.atoms.empty()) {
      residue.label_seq = label_seq;
      residue.subchain = subchain_.text(row);
      residue.entity_id = entity_.text(row);
      residue.het_flag = is_hetatm(row, id.name) ? 'H' : 'A';
    }
    return residue;
  }

  gemmi::SeqId sequence_id_of(const Row& row) const {
    gemmi::SeqId id;
    id.icode = insertion_code_.character(row, "the insertion code", ' ');
    std::string number = number_.text(row);
    if (number.empty()) return id;
    // Old files write the insertion code also after the number, as in 15A.
    if (is_letter(number.back())) {
      if (id.icode != ' ' && id.icode != number.back())
        number_.fail(row, std::string("the insertion code ") + id.icode);
      id.icode = number.back();
      number.pop_back();
    }
    id.num = number_.residue_number(row, number);
    return id;
  }

  bool is_hetatm(const Row& row, const std::string& residue_name) const {
    const std::string group = group_.text(row);
    return group.empty() ? !is_standard_monomer(residue_name) : lower_case(group.front()) == 'h';
  }

  gemmi::Atom atom_of(const Row& row) const {
    gemmi::Atom atom;
    atom.name = atom_name_.text(row);
    atom.altloc = altloc_.character(row, "the alternate location", '\0');
    atom.element = gemmi::Element(element_.text(row));
    atom.serial = static_cast<int>(row.line);
    atom.pos = {x_.number(row, "x"), y_.number(row, "y"), z_.number(row, "z")};
    atom.occ = static_cast<float>(occupancy_.number(row, "the occupancy", 1));
    atom.b_iso = static_cast<float>(b_factor_.number(row, "the B-factor", 0));
    return atom;
  }

  const Loop& table_;
  // The required columns come first, in the order in which they are reported.
  Column element_{table_, {"type_symbol"}, "type_symbol"};
  Column atom_name_{table_, {"auth_atom_id", "label_atom_id"}, "label_atom_id"};
  Column residue_name_{table_, {"auth_comp_id", "label_comp_id"}, "label_comp_id"};
  Column x_{table_, {"Cartn_x"}, "Cartn_x"};
  Column y_{table_, {"Cartn_y"}, "Cartn_y"};
  Column z_{table_, {"Cartn_z"}, "Cartn_z"};
  Column number_{table_, {"auth_seq_id", "label_seq_id"}, "auth_seq_id"};
  Column group_{table_, {"group_PDB"}};
  Column altloc_{table_, {"label_alt_id"}};
  Column chain_name_{table_, {"auth_asym_id", "label_asym_id"}};
  Column subchain_{table_, {"label_asym_id", "auth_asym_id"}};
  Column entity_{table_, {"label_entity_id"}};
  Column label_number_{table_, {"label_seq_id"}};
  Column insertion_code_{table_, {"pdbx_PDB_ins_code"}};
  Column occupancy_{table_, {"occupancy"}};
  Column b_factor_{table_, {"B_iso_or_equiv"}};
  Column model_number_{table_, {"pdbx_PDB_model_num"}};
  std::vector<gemmi::Model> models_;
  std::unordered_map<std::string, std::size_t> model_indices_;
  std::size_t model_ = 0;  // index of the current model
  ChainBuilder chain_;
};

}  // namespace

std::vector<gemmi::Model> read_models(const gemmi::cif::Loop& table,
                                      const std::vector<std::uint64_t>& lines,
                                      const CheckCallback& check) {
  ModelBuilder builder(table);
  for (std::size_t row = 0; row < table.length(); ++row) {
    check_at(row, check);
    builder.add({&table.values[row * table.width()], lines.at(row)});
  }
  return builder.take_models();
}

}  // namespace eses::detail
