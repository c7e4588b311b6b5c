// This file is valid C++17. Clang 14 cannot compile it as C++20, because the CIF documents of gemmi
// 0.5 have vectors of an incomplete type.

#include "structure/mmcif_text.hpp"

#include <algorithm>
#include <cstddef>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <new>
#include <set>
#include <utility>
#include <vector>

#include "io/text_fields.hpp"
#include "structure/mmcif_assemblies.hpp"

namespace eses::detail {
namespace {

/// A document with the line numbers of the rows of the table of atoms.
struct NumberedDocument : gemmi::cif::Document {
  explicit NumberedDocument(Checker& its_checker) : checker(its_checker) {}

  Checker& checker;
  std::vector<std::uint64_t> atom_lines;
};

constexpr const char* atom_category = "_atom_site.";  // lower case, as gemmi requires

template <class Rule>
struct NumberingAction : gemmi::cif::Action<Rule> {};

template <>
struct NumberingAction<gemmi::cif::rules::loop_value> {
  template <class Input>
  static void apply(const Input& in, NumberedDocument& document) {
    document.checker.count();
    const gemmi::cif::Loop& loop = document.items_->back().loop;
    if (loop.values.size() % loop.tags.size() == 0 &&
        gemmi::istarts_with(loop.tags.front(), atom_category))
      document.atom_lines.push_back(in.iterator().line);
    gemmi::cif::Action<gemmi::cif::rules::loop_value>::apply(in, document);
  }
};

using Block = gemmi::cif::Block;
using Item = gemmi::cif::Item;
using Loop = gemmi::cif::Loop;

bool is_atom_loop(const Item& item) {
  return item.type == gemmi::cif::ItemType::Loop && item.has_prefix(atom_category);
}

bool has_atom_table(const Block& block) {
  return std::any_of(block.items.begin(), block.items.end(),
                     [](const Item& item) { return item.has_prefix(atom_category); });
}

/// Returns the message for a text without a table of atoms.
std::string message_without_atoms(const NumberedDocument& document) {
  const auto has_tag = [&](const char* tag) {
    return std::any_of(document.blocks.begin(), document.blocks.end(),
                       [tag](const Block& block) { return block.has_tag(tag); });
  };
  const std::string start = "no atoms found; ";
  if (document.blocks.empty()) return start + "the file has no data block";
  if (has_tag("_atom_site_fract_x"))
    return start +
           "the coordinates are fractional (_atom_site_fract_x), as in CIF files of small "
           "molecules; convert it with `obabel FILE -O FILE.pdb`";
  if (has_tag("_chem_comp_atom.atom_id"))
    return start +
           "this is the definition of a chemical component (_chem_comp_atom); convert it with "
           "`gemmi convert FILE FILE.pdb`";
  return start + "the file has no _atom_site table";
}

/// Returns the line of the table of atoms, or 0 if a block has none.
std::uint64_t atom_table_line(const Block& block) {
  for (const Item& item : block.items)
    if (item.has_prefix(atom_category)) return static_cast<std::uint64_t>(item.line_number);
  return 0;
}

/// Throws MmcifError if two data blocks have the same name, ignoring case, or if both have atoms.
void check_blocks(const NumberedDocument& document) {
  std::set<std::string> names;
  const Block* with_atoms = nullptr;
  for (const Block& block : document.blocks) {
    if (!names.insert(gemmi::to_lower(block.name)).second)
      throw MmcifError{0, "there are two data blocks " + detail::quoted(block.name) +
                              "; remove or rename one of them"};
    if (!has_atom_table(block)) continue;
    if (with_atoms != nullptr)
      throw MmcifError{atom_table_line(block),
                       "the data blocks " + detail::quoted(with_atoms->name) + " and " +
                           detail::quoted(block.name) + " both have atoms; keep one of them"};
    with_atoms = &block;
  }
}

/// Returns the data block that has the atoms. Throws MmcifError if there is none.
Block& find_atom_block(NumberedDocument& document) {
  const auto found = std::find_if(document.blocks.begin(), document.blocks.end(), has_atom_table);
  if (found == document.blocks.end()) throw MmcifError{0, message_without_atoms(document)};
  return *found;
}

/// Converts a table of one atom that is not a loop to a loop. Returns the line of its atom.
std::uint64_t make_atom_loop(Block& block) {
  Item table{gemmi::cif::LoopArg{}};
  int line = 0;
  for (Item& item : block.items) {
    if (item.type != gemmi::cif::ItemType::Pair || !item.has_prefix(atom_category)) continue;
    if (line == 0 || item.pair[0] == std::string(atom_category) + "id") line = item.line_number;
    table.loop.tags.push_back(item.pair[0]);
    table.loop.values.push_back(item.pair[1]);
    item.erase();
  }
  block.items.push_back(std::move(table));
  return static_cast<std::uint64_t>(line);
}

int find_column(const Loop& loop, const std::string& name) {
  return loop.find_tag(std::string(atom_category) + name);
}

/// A column that is added to a table.
struct AddedColumn {
  std::string name;
  int source = -1;    ///< index of the column that has its values; -1 if there is none
  std::string value;  ///< the value of all rows if there is no source
};

/// Returns the columns that gemmi requires and the table lacks. Programs such as PyMOL do not write
/// all of them. Throws MmcifError if the table lacks a column without a default.
std::vector<AddedColumn> missing_columns(const Loop& loop) {
  const auto require = [&](const std::string& name, const std::string& other) {
    if (find_column(loop, name) < 0 && find_column(loop, other) < 0)
      throw MmcifError{0, "the _atom_site table lacks the column " + name};
  };
  require("type_symbol", "type_symbol");
  require("label_atom_id", "auth_atom_id");
  require("label_comp_id", "auth_comp_id");
  for (const char* const name : {"Cartn_x", "Cartn_y", "Cartn_z"}) require(name, name);
  require("auth_seq_id", "label_seq_id");
  std::vector<AddedColumn> missing;
  for (const AddedColumn& column :
       {AddedColumn{"id", -1, "."}, AddedColumn{"label_alt_id", -1, "."},
        AddedColumn{"label_asym_id", find_column(loop, "auth_asym_id"), "."},
        AddedColumn{"occupancy", -1, "1"}, AddedColumn{"B_iso_or_equiv", -1, "0"},
        AddedColumn{"auth_seq_id", find_column(loop, "label_seq_id"), "."}})
    if (find_column(loop, column.name) < 0) missing.push_back(column);
  return missing;
}

void add_columns(Loop& loop, const std::vector<AddedColumn>& columns, Checker& checker) {
  if (columns.empty()) return;
  const std::size_t rows = loop.length(), old_width = loop.width();
  std::vector<std::string> values;
  values.reserve(rows * (old_width + columns.size()));
  for (std::size_t row = 0; row < rows; ++row) {
    checker.count();
    const std::size_t first = values.size();
    for (std::size_t i = 0; i < old_width; ++i)
      values.push_back(std::move(loop.values[row * old_width + i]));
    for (const AddedColumn& column : columns)
      values.push_back(column.source < 0 ? column.value
                                         : values[first + static_cast<std::size_t>(column.source)]);
  }
  loop.values = std::move(values);
  for (const AddedColumn& column : columns)
    loop.tags.push_back(std::string(atom_category) + column.name);
}

/// Renames the columns that gemmi would read and this program does not use. gemmi does not check
/// the range of integers such as charges, and has two atoms where hydrogen and deuterium are mixed.
void hide_unused_columns(Loop& loop) {
  for (const char* const name : {"pdbx_formal_charge", "pdbx_tls_group_id", "ccp4_hd_mixture"})
    if (const int column = find_column(loop, name); column >= 0)
      loop.tags[static_cast<std::size_t>(column)] = std::string(atom_category) + "unused";
}

/// Throws MmcifError if a residue number has more digits than integers of gemmi can have.
void check_residue_number(const std::string& number, std::uint64_t line) {
  constexpr std::ptrdiff_t max_digits = 9;
  if (std::count_if(number.begin(), number.end(), gemmi::is_digit) > max_digits)
    throw MmcifError{line, "expected a residue number of at most " + std::to_string(max_digits) +
                               " digits, found " + detail::quoted(number)};
}

/// Prepares a loop of atoms for gemmi. Replaces the serial numbers of the atoms by their line
/// numbers. `lines` is used from `row` on, which is advanced.
void prepare_atom_loop(Item& item, const std::vector<std::uint64_t>& lines, std::size_t& row,
                       Checker& checker) {
  Loop& loop = item.loop;
  add_columns(loop, missing_columns(loop), checker);
  hide_unused_columns(loop);
  const auto id = static_cast<std::size_t>(find_column(loop, "id"));
  const std::size_t rows = loop.length(), width = loop.width();
  for (const char* const name : {"auth_seq_id", "label_seq_id"})
    if (const int column = find_column(loop, name); column >= 0)
      for (std::size_t i = 0; i < rows && row + i < lines.size(); ++i)
        check_residue_number(loop.values[i * width + static_cast<std::size_t>(column)],
                             lines[row + i]);
  for (std::size_t i = 0; i < rows && row + i < lines.size(); ++i)
    loop.values[i * width + id] = std::to_string(lines[row + i]);
  row += rows;
}

/// Prepares the tables of atoms for gemmi.
void prepare_atoms(Block& block, NumberedDocument& document) {
  if (std::none_of(block.items.begin(), block.items.end(), is_atom_loop))
    document.atom_lines = {make_atom_loop(block)};
  std::size_t row = 0;
  for (Item& item : block.items)
    if (is_atom_loop(item)) prepare_atom_loop(item, document.atom_lines, row, document.checker);
}

/// Removes the tables that this program does not use. gemmi would read many of them, and fail at
/// faults in tables that do not matter here.
void remove_unused_tables(Block& block) {
  for (Item& item : block.items) {
    bool is_used = false;
    for (const char* const category : {atom_category, "_entity.", "_entity_poly.", "_struct_asym."})
      is_used = is_used || item.has_prefix(category);
    if (!is_used) item.erase();
  }
}

}  // namespace

gemmi::Structure parse_mmcif_text(std::string_view text, const std::string& name,
                                  const std::string& assembly, Checker& checker) {
  try {
    NumberedDocument document(checker);
    document.source = name;
    gemmi::cif::pegtl::memory_input<> in(text.data(), text.size(), name);
    gemmi::cif::pegtl::parse<gemmi::cif::rules::file, NumberingAction, gemmi::cif::Errors>(
        in, document);
    check_blocks(document);
    gemmi::cif::check_for_missing_values(document);
    gemmi::cif::check_for_duplicates(document);
    checker.check();
    Block& block = find_atom_block(document);
    std::vector<gemmi::Assembly> assemblies = read_assemblies(block, assembly);
    remove_unused_tables(block);
    prepare_atoms(block, document);
    checker.check();
    gemmi::Structure structure = gemmi::make_structure_from_block(block);
    structure.assemblies = std::move(assemblies);
    return structure;
  } catch (const MmcifError&) {
    throw;
  } catch (const tao::pegtl::parse_error& error) {
    throw MmcifError{error.positions().front().line, std::string(error.message())};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw MmcifError{0, error.what()};
  }
}

}  // namespace eses::detail
