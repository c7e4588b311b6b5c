// This file is valid C++17, for the reason given in mmcif_text.cpp.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gemmi/numb.hpp>
#include <gemmi/resinfo.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "input/pdb_elements.hpp"
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
  /// Finds the column `name`, or `other` if the table does not have it.
  Column(gemmi::cif::Block& block, const std::string& name, const std::string& other = "")
      : values_(block.find_values(atom_category + name)), tag_(atom_category + name) {
    if (!other.empty()) others_ = block.find_values(atom_category + other);
    if (!values_ && others_) {
      std::swap(values_, others_);
      tag_ = atom_category + other;
    }
  }

  bool is_found() const { return static_cast<bool>(values_); }
  int length() const { return values_.length(); }

  /// Returns the value, or that of the other column if it is unknown, without quotation marks;
  /// empty if both are unknown, which files write as `.` or `?`.
  std::string text(const Row& row) const {
    std::string value = values_ ? gemmi::cif::as_string(values_[row.index]) : std::string();
    return value.empty() && others_ ? gemmi::cif::as_string(others_[row.index]) : value;
  }

  /// Returns a value of one character, or `unknown`.
  char character(const Row& row, const char* quantity, char unknown) const {
    const std::string value = text(row);
    if (value.size() > 1) fail(row, std::string("one character for ") + quantity);
    return value.empty() ? unknown : value.front();
  }

  double number(const Row& row, const char* quantity, const char* unknown = "") const {
    const std::string known = text(row);
    const double value = gemmi::cif::as_number(known.empty() ? unknown : known);
    if (!std::isfinite(value)) fail(row, std::string("a number for ") + quantity);
    return value;
  }

  /// Returns the value, or its part `number`, as a residue number.
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
    const std::string value = text(row);
    throw MmcifError{row.line, "expected " + expected + " in " + tag_ + ", found " +
                                   detail::quoted(value.empty() ? values_[row.index] : value)};
  }

 private:
  // In gemmi 0.5 no access to values is const.
  mutable gemmi::cif::Column values_, others_;
  std::string tag_;
};

/// Returns a column that the table must have. Throws MmcifError with its name otherwise.
Column required(const std::string& name, Column column) {
  if (!column.is_found()) throw MmcifError{0, "the _atom_site table lacks the column " + name};
  return column;
}

/// Returns the charges of the first set in the table of charges, by the ids of the atoms.
std::unordered_map<std::string, double> charges_by_id(gemmi::cif::Block& block) {
  std::unordered_map<std::string, double> charges;
  gemmi::cif::Table table = block.find(charge_category, {"type_id", "atom_id", "charge"});
  std::string first_set;
  for (const auto& row : table) {
    if (charges.empty()) first_set = row.str(0);
    if (row.str(0) == first_set) charges.emplace(row.str(1), gemmi::cif::as_number(row[2]));
  }
  return charges;
}

/// Returns whether the residue is a standard amino acid or nucleotide, as in ATOM records.
bool is_standard_monomer(const std::string& residue_name) {
  const auto& info = gemmi::find_tabulated_residue(residue_name);
  return info.is_standard() && (info.is_amino_acid() || info.is_nucleic_acid());
}

/// A residue of the chain of a row. Its number is unknown in some files.
struct ResidueKey {
  std::string chain;
  gemmi::ResidueId id;

  bool has_number() const { return id.seqid.num.has_value(); }
  bool operator==(const ResidueKey& other) const { return id == other.id && chain == other.chain; }
};

/// Checks the rows and makes the chains of the chosen model.
class AtomTable {
 public:
  AtomTable(gemmi::cif::Block& block, const ParseOptions& options, ParsedStructure& parsed)
      : block_(block), options_(options), parsed_(parsed) {}

  std::vector<gemmi::Chain> read() {
    parsed_.has_label_chains = label_chain_.is_found();
    add_charges();
    for (std::size_t i = 0; i < parsed_.sources.size(); ++i) {
      check_at(i, options_.check);
      const Row row = row_of(i);
      ResidueKey residue = residue_of(row);
      gemmi::Atom atom = atom_of(row, residue.id.name);
      if (!is_in_chosen_model(row)) continue;
      if (!residue.has_number()) number_residue(atom, residue);
      parsed_.sources[i].is_element_by_name = element_text(row, residue.id.name).empty();
      const auto complete = [&](gemmi::Residue& added) { complete_residue(row, added); };
      chains_.residue(residue.chain, residue.id, complete).atoms.push_back(std::move(atom));
    }
    return std::move(chains_.chains);
  }

 private:
  Row row_of(std::size_t i) const { return {static_cast<int>(i), parsed_.sources[i].line}; }

  bool is_in_chosen_model(const Row& row) {
    std::string name = model_number_.text(row);
    if (name.empty()) name = "1";
    if (name == last_model_) return is_chosen_;
    ModelList& models = parsed_.models;
    const std::vector<std::string>& known = models.names;
    is_chosen_ = std::find(known.begin(), known.end(), name) == known.end() ? models.add(name)
                                                                            : name == models.chosen;
    last_model_ = name;
    return is_chosen_;
  }

  void add_charges() {
    if (!charge_.is_found() && charges_.empty()) return;
    parsed_.charges.assign(parsed_.sources.size(), NAN);
    for (std::size_t i = 0; i < parsed_.sources.size(); ++i)
      if (charge_.is_found())
        parsed_.charges[i] = gemmi::cif::as_number(charge_.text(row_of(i)));
      else if (const auto found = charges_.find(id_.text(row_of(i))); found != charges_.end())
        parsed_.charges[i] = found->second;
  }

  ResidueKey residue_of(const Row& row) const {
    ResidueKey key;
    key.chain = chain_name_.text(row);
    key.id.name = residue_name_.text(row);
    key.id.seqid.icode = insertion_code_.character(row, "the insertion code", ' ');
    std::string number = number_.text(row);
    if (number.empty()) return key;
    // Old files write the insertion code also after the number, as in 15A.
    if (is_letter(number.back())) {
      if (key.id.seqid.icode != ' ' && key.id.seqid.icode != number.back())
        number_.fail(row, std::string("the insertion code ") + key.id.seqid.icode);
      key.id.seqid.icode = number.back();
      number.pop_back();
    }
    key.id.seqid.num = number_.residue_number(row, number);
    return key;
  }

  // Gives a residue without a number, such as a water or an ion, a number behind all numbers of the
  // file. A new residue begins with another name or chain, or with an atom that repeats.
  void number_residue(const gemmi::Atom& atom, ResidueKey& residue) {
    if (last_number_ == 0)
      for (std::size_t i = 0; i < parsed_.sources.size(); ++i)
        if (const auto other = residue_of(row_of(i)); other.has_number())
          last_number_ = std::max(last_number_, *other.id.seqid.num);
    std::set<char>& known = unnumbered_altlocs_[atom.name];
    // An atom has one location without a letter, or several with letters.
    if (!(residue == unnumbered_) || known.count(atom.altloc) > 0 ||
        (!known.empty() && (atom.altloc == '\0' || known.count('\0') > 0))) {
      ++last_number_;
      unnumbered_altlocs_.clear();
    }
    unnumbered_ = residue;
    unnumbered_altlocs_[atom.name].insert(atom.altloc);
    residue.id.seqid.num = last_number_;
  }

  // Returns the symbol of the file. It is empty if the names decide: names in amino acids and
  // nucleotides tell the elements that the file marks as unknown.
  std::string element_text(const Row& row, const std::string& residue) const {
    std::string text = element_.text(row);
    if (is_unknown_element(text) && is_polymer_residue(residue)) text.clear();
    return text;
  }

  gemmi::Atom atom_of(const Row& row, const std::string& residue) const {
    gemmi::Atom atom;
    atom.name = atom_name_.text(row);
    const std::string element = element_text(row, residue);
    atom.element = gemmi::Element(element.empty() ? symbol_by_name(atom.name, residue) : element);
    atom.altloc = altloc_.character(row, "the alternate location", '\0');
    if (const std::string number = label_number_.text(row); !number.empty())
      label_number_.residue_number(row, number);
    atom.pos = {x_.number(row, "x"), y_.number(row, "y"), z_.number(row, "z")};
    atom.occ = static_cast<float>(
        occupancy_.number(row, options_.needs_occupancies ? "the radius" : "the occupancy",
                          options_.needs_occupancies ? "" : "1"));
    atom.b_iso = static_cast<float>(b_factor_.number(row, "the B-factor", "0"));
    atom.serial = row.index;
    return atom;
  }

  // Completes a new residue by the row of its first atom.
  void complete_residue(const Row& row, gemmi::Residue& residue) const {
    residue.subchain = subchain_.text(row);
    if (options_.label_chains) residue.segment = auth_chain_.text(row);
    residue.entity_id = entity_.text(row);
    residue.het_flag = is_hetatm(row, residue.name) ? 'H' : 'A';
  }

  bool is_hetatm(const Row& row, const std::string& residue_name) const {
    const std::string group = group_.text(row);
    return group.empty() ? !is_standard_monomer(residue_name) : lower_case(group.front()) == 'h';
  }

  gemmi::cif::Block& block_;
  const ParseOptions& options_;
  ParsedStructure& parsed_;
  // The required columns come first, in the order in which they are reported.
  Column atom_name_ = required("label_atom_id", {block_, "auth_atom_id", "label_atom_id"});
  Column residue_name_ = required("label_comp_id", {block_, "auth_comp_id", "label_comp_id"});
  Column x_ = required("Cartn_x", {block_, "Cartn_x"});
  Column y_ = required("Cartn_y", {block_, "Cartn_y"});
  Column z_ = required("Cartn_z", {block_, "Cartn_z"});
  Column number_ = required("auth_seq_id", {block_, "auth_seq_id", "label_seq_id"});
  Column element_{block_, "type_symbol"};
  Column group_{block_, "group_PDB"};
  Column altloc_{block_, "label_alt_id"};
  Column auth_chain_{block_, "auth_asym_id", "label_asym_id"};
  Column label_chain_ = options_.label_chains ? required("label_asym_id", {block_, "label_asym_id"})
                                              : Column(block_, "label_asym_id");
  const Column& chain_name_ = options_.label_chains ? label_chain_ : auth_chain_;
  Column subchain_{block_, "label_asym_id", "auth_asym_id"};
  Column entity_{block_, "label_entity_id"};
  Column label_number_{block_, "label_seq_id"};
  Column insertion_code_{block_, "pdbx_PDB_ins_code"};
  Column occupancy_{block_, "occupancy"};
  Column b_factor_{block_, "B_iso_or_equiv"};
  Column model_number_{block_, "pdbx_PDB_model_num"};
  Column charge_{block_, "partial_charge"};
  Column id_{block_, "id"};
  std::unordered_map<std::string, double> charges_ = charges_by_id(block_);
  ChainBuilder chains_;
  int last_number_ = 0;                                       // of residues without a number
  ResidueKey unnumbered_;                                     // the last of these
  std::map<std::string, std::set<char>> unnumbered_altlocs_;  // by names of its atoms
  std::string last_model_;
  bool is_chosen_ = false;
};

}  // namespace

std::vector<gemmi::Chain> read_atom_table(gemmi::cif::Block& block, const ParseOptions& options,
                                          ParsedStructure& parsed) {
  return AtomTable(block, options, parsed).read();
}

}  // namespace eses::detail
