// This file is valid C++17. Clang 14 cannot compile it as C++20, because the CIF documents of gemmi
// 0.5 have vectors of an incomplete type.

#include <algorithm>
#include <cstddef>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <set>
#include <utility>
#include <vector>

#include "input/chain_builder.hpp"
#include "input/check_at.hpp"
#include "input/mmcif_tables.hpp"
#include "input/parse_structure.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

namespace pegtl = gemmi::cif::pegtl;
namespace rules = gemmi::cif::rules;
using Block = gemmi::cif::Block;
using Item = gemmi::cif::Item;
using ItemType = gemmi::cif::ItemType;
using Loop = gemmi::cif::Loop;

bool is_atom_table(const Item& item) { return item.has_prefix(atom_category); }

/// Returns whether a table has atoms or the types of entities. Prefixes are in lower case.
bool is_needed_table(const Item& item) {
  return is_atom_table(item) || item.has_prefix("_entity.") || item.has_prefix("_entity_poly.") ||
         item.has_prefix("_struct_asym.");
}

/// A document that has only the tags of loops that this program does not use.
struct StructureDocument : gemmi::cif::Document {
  explicit StructureDocument(const CheckCallback& its_check) : check(its_check) {}

  const CheckCallback& check;
  std::uint64_t value_count = 0;          ///< number of values of loops
  bool keeps_values = false;              ///< whether the values of the current loop are kept
  std::vector<std::uint64_t> atom_lines;  ///< line numbers of the rows of the table of atoms
};

/// The actions of gemmi's parser for a StructureDocument.
template <class Rule>
struct StructureAction : gemmi::cif::Action<Rule> {};

template <>
struct StructureAction<rules::loop_tag> {
  template <class Input>
  static void apply(const Input& in, StructureDocument& document) {
    gemmi::cif::Action<rules::loop_tag>::apply(in, document);
    const bool is_in_frame = document.items_ != &document.blocks.back().items;
    const Item& table = document.items_->back();
    document.keeps_values = !is_in_frame && (is_needed_table(table) || is_assembly_table(table));
  }
};

template <>
struct StructureAction<rules::loop_value> {
  template <class Input>
  static void apply(const Input& in, StructureDocument& document) {
    check_at(++document.value_count, document.check);
    if (!document.keeps_values) return;
    const Item& table = document.items_->back();
    if (table.loop.values.size() % table.loop.tags.size() == 0 && is_atom_table(table))
      document.atom_lines.push_back(in.iterator().line);
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

void parse_document(std::string_view text, StructureDocument& document) {
  try {
    pegtl::memory_input<> in(text.data(), text.size(), "");
    pegtl::parse<rules::file, StructureAction, gemmi::cif::Errors>(in, document);
  } catch (const pegtl::parse_error& error) {
    const pegtl::position& at = error.positions().front();
    const std::string message(error.message());
    throw MmcifError{at.line,
                     message == "parse error" ? syntax_message(text.substr(at.byte)) : message};
  }
}

std::uint64_t line_of(const Item& item) { return static_cast<std::uint64_t>(item.line_number); }

/// Returns the message for a text without a table of atoms.
std::string message_without_atoms(const StructureDocument& document) {
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

/// Returns the data block that has the atoms. Throws MmcifError if there is none, if another block
/// has atoms, or if another block has the same name, ignoring case.
Block& find_atom_block(StructureDocument& document) {
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
  if (found == nullptr) throw MmcifError{0, message_without_atoms(document)};
  for (const Block& block : document.blocks)
    if (&block != found && gemmi::iequal(block.name, gemmi::to_lower(found->name)))
      throw MmcifError{0, "there are two data blocks " + detail::quoted(block.name) +
                              "; remove or rename one of them"};
  return *found;
}

/// Converts a table of one atom that is not a loop to a loop. Returns the line of its atom.
std::uint64_t make_atom_loop(Block& block) {
  Item table{gemmi::cif::LoopArg{}};
  std::uint64_t line = 0;
  for (Item& item : block.items) {
    if (!is_atom_table(item)) continue;
    if (line == 0 || item.pair[0] == std::string(atom_category) + "id") line = line_of(item);
    table.loop.tags.push_back(item.pair[0]);
    table.loop.values.push_back(item.pair[1]);
    item.erase();
  }
  block.items.push_back(std::move(table));
  return line;
}

/// Returns the table of atoms. A table of one atom, which is not a loop, becomes a loop.
Loop& atom_loop(Block& block, StructureDocument& document) {
  const auto is_atom_loop = [](const Item& item) {
    return item.type == ItemType::Loop && is_atom_table(item);
  };
  auto loop = std::find_if(block.items.begin(), block.items.end(), is_atom_loop);
  if (loop == block.items.end()) {
    document.atom_lines = {make_atom_loop(block)};
    loop = block.items.end() - 1;
  } else if (std::count_if(block.items.begin(), block.items.end(), is_atom_table) > 1) {
    throw MmcifError{line_of(*loop), "the _atom_site table is in several parts; join them"};
  }
  return loop->loop;
}

/// Lists the subchains of the entities by their atoms, where the file lacks _struct_asym.
void add_subchains(gemmi::Structure& structure) {
  if (structure.models.empty()) return;
  for (const gemmi::Chain& chain : structure.models.front().chains)
    for (const gemmi::ConstResidueSpan& subchain : chain.subchains()) {
      const gemmi::Residue& first = subchain.front();
      gemmi::Entity* const entity = structure.get_entity(first.entity_id);
      if (entity != nullptr && !gemmi::in_vector(first.subchain, entity->subchains))
        entity->subchains.push_back(first.subchain);
    }
}

/// Gives residues the types of their entities. gemmi finds the entity by the subchain. If the file
/// lacks _struct_asym, a subchain may have residues of several entities.
void set_entity_types(Block& block, gemmi::Structure& structure) {
  for (const gemmi::cif::Table::Row row : block.find("_entity.", {"id", "type"}))
    structure.entities.emplace_back(row.str(0)).entity_type =
        gemmi::entity_type_from_string(row.str(1));
  gemmi::cif::Table subchains = block.find("_struct_asym.", {"id", "entity_id"});
  for (const gemmi::cif::Table::Row row : subchains)
    if (gemmi::Entity* const entity = structure.get_entity(row.str(1)))
      entity->subchains.push_back(row.str(0));
  if (!subchains.ok()) add_subchains(structure);
  gemmi::impl::fill_residue_entity_type(structure);
  if (subchains.ok()) return;
  for (gemmi::Model& model : structure.models)
    for (gemmi::Chain& chain : model.chains)
      for (gemmi::Residue& residue : chain.residues) {
        const gemmi::Entity* const entity = structure.get_entity(residue.entity_id);
        if (entity != nullptr && entity->entity_type != gemmi::EntityType::Unknown)
          residue.entity_type = entity->entity_type;
      }
}

}  // namespace

void check_tables(const Block& block, bool (*is_used)(const Item& item)) {
  std::set<std::string> tags;
  for (const Item& item : block.items) {
    if (!is_used(item)) continue;
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

gemmi::Structure parse_mmcif_text(std::string_view text, std::string_view name,
                                  const std::string& assembly, const CheckCallback& check) {
  try {
    StructureDocument document(check);
    parse_document(text, document);
    Block& block = find_atom_block(document);
    check_tables(block, is_needed_table);
    gemmi::Structure structure;
    structure.input_format = gemmi::CoorFormat::Mmcif;
    structure.assemblies = read_assemblies(block, assembly);
    structure.models = read_models(atom_loop(block, document), document.atom_lines, check);
    split_residues(structure);
    set_entity_types(block, structure);
    return structure;
  } catch (const MmcifError& error) {
    fail_at_line(name, error.line, error.message);
  }
}

}  // namespace eses::detail
