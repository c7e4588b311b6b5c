// This file is valid C++17. Clang 14 cannot compile it as C++20, because the CIF documents of gemmi
// 0.5 have vectors of an incomplete type.

#include <algorithm>
#include <cstddef>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "input/advice.hpp"
#include "input/structure/mmcif_tables.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

namespace pegtl = gemmi::cif::pegtl;
namespace rules = gemmi::cif::rules;
using Block = gemmi::cif::Block;
using Item = gemmi::cif::Item;
using ItemType = gemmi::cif::ItemType;
using Loop = gemmi::cif::Loop;

bool is_atom_tag(const std::string& tag) { return gemmi::istarts_with(tag, atom_category); }

/// Returns whether the table of a tag has atoms, their charges or the types of entities.
bool is_needed_tag(const std::string& tag) {
  return is_atom_tag(tag) || gemmi::istarts_with(tag, charge_category) ||
         gemmi::istarts_with(tag, "_entity.") || gemmi::istarts_with(tag, "_struct_asym.");
}

const std::string& tag_of(const Item& item) {
  static const std::string none;
  if (item.type == ItemType::Pair) return item.pair[0];
  return item.type == ItemType::Loop ? item.loop.tags.front() : none;
}

bool is_atom_table(const Item& item) { return is_atom_tag(tag_of(item)); }

/// A document that has only the tags of loops that this program does not use.
struct StructureDocument : gemmi::cif::Document {
  explicit StructureDocument(const CheckCallback& its_check) : check(its_check) {}

  /// The item being read in the current data block.
  Item& item() { return blocks.back().items.back(); }

  const CheckCallback& check;
  std::uint64_t value_count = 0;          ///< number of values of loops
  bool keeps_values = false;              ///< whether the values of the current loop are kept
  std::vector<std::uint64_t> atom_lines;  ///< line numbers of the rows of the table of atoms
  std::size_t rest = 0;                   ///< bytes of the text from the first row of atoms on
};

/// Makes room for the values of the table of atoms when its second row begins, as if all rows were
/// as long as the first one. `rest` is the number of bytes that follow.
void reserve_rows(Loop& loop, std::size_t rest, StructureDocument& document) {
  if (loop.values.empty()) document.rest = rest;
  if (loop.values.size() == loop.tags.size())
    loop.values.reserve((2 + rest / (document.rest - rest)) * loop.tags.size());
}

/// The actions of gemmi's parser for a StructureDocument.
template <class Rule>
struct StructureAction : gemmi::cif::Action<Rule> {};

template <>
struct StructureAction<rules::loop_tag> {
  template <class Input>
  static void apply(const Input& in, StructureDocument& document) {
    gemmi::cif::Action<rules::loop_tag>::apply(in, document);
    // The item is another one if the loop is in a save frame.
    const std::string& table = tag_of(document.item());
    document.keeps_values = is_needed_tag(table) || is_assembly_tag(table);
  }
};

template <>
struct StructureAction<rules::loop_value> {
  template <class Input>
  static void apply(const Input& in, StructureDocument& document) {
    check_at(++document.value_count, document.check);
    if (!document.keeps_values) return;
    Loop& loop = document.item().loop;
    if (loop.values.size() % loop.tags.size() == 0 && is_atom_table(document.item())) {
      document.atom_lines.push_back(in.iterator().line);
      reserve_rows(loop, in.input().size(0), document);
    }
    gemmi::cif::Action<rules::loop_value>::apply(in, document);
  }
};

// gemmi counts the values of each loop here. check_tables() does it for the tables that are used.
template <>
struct StructureAction<rules::loop> : pegtl::nothing<rules::loop> {};

/// Returns the message for a syntax error at the beginning of `rest`.
std::string syntax_message(std::string_view rest) {
  if (rest.empty()) return "unexpected end of the file";
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
  const auto special =
      std::find_if(word.begin(), word.end(), [](char c) { return c < '!' || c > '~'; });
  if (special != word.end())
    return "unexpected character " + detail::quoted(std::string(1, *special)) +
           "; quote values with characters other than printable ASCII";
  return "unexpected " + detail::quoted(word) +
         "; quote values that begin with _, # or $, or with the reserved words data_, loop_, "
         "global_, save_ or stop_";
}

/// Returns the position of an error, which is a member of old versions of PEGTL.
template <class ParseError>
auto position_of(const ParseError& error, int) -> decltype(error.positions().front()) {
  return error.positions().front();
}
template <class ParseError>
auto position_of(const ParseError& error, long) {
  return error.positions.front();
}

void parse_document(std::string_view text, StructureDocument& document) {
  try {
    pegtl::memory_input<> in(text.data(), text.size(), "");
    pegtl::parse<rules::file, StructureAction, gemmi::cif::Errors>(in, document);
  } catch (const pegtl::parse_error& error) {
    const auto at = position_of(error, 0);
    const std::string message(error.what());  // begins with the position
    const std::string what = message.substr(message.find(": ") + 2);
    throw MmcifError{at.line, what == "parse error" ? syntax_message(text.substr(at.byte)) : what};
  }
}

std::uint64_t line_of(const Item& item) { return static_cast<std::uint64_t>(item.line_number); }

/// Returns the message for a text without a table of atoms.
std::string message_without_atoms(const StructureDocument& document, std::string_view name) {
  const auto has_tag = [&](const char* tag) {
    return std::any_of(document.blocks.begin(), document.blocks.end(),
                       [tag](const Block& block) { return block.has_tag(tag); });
  };
  const std::string start = "no atoms found; ";
  if (document.blocks.empty()) return start + "the file has no data block";
  if (has_tag("_atom_site_fract_x"))
    return start +
           "the coordinates are fractional (_atom_site_fract_x), as in CIF files of small "
           "molecules; " +
           advice_for(name, "convert it with `obabel FILE -O FILE.pdb`");
  if (has_tag("_chem_comp_atom.atom_id"))
    return start + "this is the definition of a chemical component (_chem_comp_atom); " +
           advice_for(name, "convert it with `gemmi convert FILE FILE.pdb`");
  return start + "the file has no _atom_site table";
}

/// Returns the data block that has the atoms. Throws MmcifError if there is none, if another block
/// has atoms, or if another block has the same name, ignoring case.
Block& find_atom_block(StructureDocument& document, std::string_view name) {
  Block* found = nullptr;
  for (Block& block : document.blocks) {
    const auto table = std::find_if(block.items.begin(), block.items.end(), is_atom_table);
    if (table == block.items.end()) continue;
    if (found != nullptr)
      throw MmcifError{line_of(*table), "the data blocks " + detail::quoted(found->name) + " and " +
                                            detail::quoted(block.name) +
                                            " both have atoms; keep one of them"};
    found = &block;
  }
  if (found == nullptr) throw MmcifError{0, message_without_atoms(document, name)};
  for (const Block& block : document.blocks)
    if (&block != found && gemmi::iequal(block.name, gemmi::to_lower(found->name)))
      throw MmcifError{0, "there are two data blocks " + detail::quoted(block.name) +
                              "; remove or rename one of them"};
  return *found;
}

/// Returns the line of each atom. A table that is not a loop has one atom, in the line of its id or
/// of its first tag.
std::vector<std::uint64_t> lines_of_atoms(Block& block, const StructureDocument& document) {
  const auto first = std::find_if(block.items.begin(), block.items.end(), is_atom_table);
  const auto is_loop = [](const Item& item) {
    return item.type == ItemType::Loop && is_atom_table(item);
  };
  const auto loop = std::find_if(block.items.begin(), block.items.end(), is_loop);
  if (loop == block.items.end()) {
    const Item* const id = block.find_pair_item("_atom_site.id");
    return {line_of(id != nullptr ? *id : *first)};
  }
  if (std::count_if(block.items.begin(), block.items.end(), is_atom_table) > 1)
    throw MmcifError{line_of(*loop), "the _atom_site table is in several parts; join them"};
  return document.atom_lines;
}

/// Gives residues the types of their entities, by their subchains or, if the file does not list
/// these, by their own columns. Versions of gemmi differ in the types of other residues.
void set_entity_types(gemmi::Structure& structure, bool lists_subchains) {
  std::unordered_map<std::string, gemmi::EntityType> types;
  for (const gemmi::Entity& entity : structure.entities) {
    if (!lists_subchains) types.emplace(entity.name, entity.entity_type);
    for (const std::string& subchain : entity.subchains)
      if (lists_subchains) types.emplace(subchain, entity.entity_type);
  }
  for (gemmi::Chain& chain : structure.models.front().chains)
    for (gemmi::Residue& residue : chain.residues) {
      const auto found = types.find(lists_subchains ? residue.subchain : residue.entity_id);
      residue.entity_type = found == types.end() ? gemmi::EntityType::Unknown : found->second;
    }
}

/// Converts the used tables of a block.
ParsedStructure convert(Block& block, const StructureDocument& document,
                        const ParseOptions& options) {
  ParsedStructure result;
  result.models.wanted = options.model;
  std::vector<gemmi::Assembly> assemblies = read_assemblies(block, options.assembly);
  result.lines = lines_of_atoms(block, document);
  AtomTable atoms = read_atom_table(block, result.lines, result.models, options);
  const bool lists_subchains = block.find("_struct_asym.", {"id", "entity_id"}).ok();
  // gemmi reads the entities. It would take quadratic time for chains of many residues.
  gemmi::vector_remove_if(block.items, [](const Item& item) {
    return is_atom_table(item) || !is_needed_tag(tag_of(item));
  });
  result.structure = gemmi::make_structure_from_block(block);
  result.structure.assemblies = std::move(assemblies);
  result.guessed_elements = std::move(atoms.guessed_elements);
  result.charges = std::move(atoms.charges);
  result.has_label_chains = atoms.has_label_chains;
  if (atoms.chains.empty()) return result;
  result.structure.models = {make_model()};
  result.structure.models.front().chains = std::move(atoms.chains);
  set_entity_types(result.structure, lists_subchains);
  return result;
}

}  // namespace

void check_tables(const Block& block, bool (*is_used)(const std::string& tag)) {
  std::set<std::string> tags;
  for (const Item& item : block.items) {
    if (!is_used(tag_of(item))) continue;
    const auto add_tag = [&](const std::string& tag) {
      if (!tags.insert(gemmi::to_lower(tag)).second)
        throw MmcifError{line_of(item), "duplicate tag " + tag};
    };
    if (item.type == ItemType::Pair) {
      add_tag(item.pair[0]);
      if (item.pair[1].empty()) throw MmcifError{line_of(item), item.pair[0] + " has no value"};
    } else {
      for (const std::string& tag : item.loop.tags) add_tag(tag);
      if (item.loop.values.size() % item.loop.tags.size() != 0)
        throw MmcifError{line_of(item), "wrong number of values in the loop"};
    }
  }
}

ParsedStructure parse_mmcif_text(std::string_view text, std::string_view name,
                                 const ParseOptions& options) {
  try {
    StructureDocument document(options.check);
    parse_document(text, document);
    Block& block = find_atom_block(document, name);
    check_tables(block, is_needed_tag);
    return convert(block, document, options);
  } catch (const MmcifError& error) {
    fail_at_line(name, error.line, error.message);
  }
}

}  // namespace eses::detail
