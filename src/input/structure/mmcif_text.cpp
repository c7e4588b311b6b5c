// This file is valid C++17. Clang 14 cannot compile it as C++20, because the CIF documents of gemmi
// 0.5 have vectors of an incomplete type.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <gemmi/numb.hpp>
#include <map>
#include <set>
#include <string>
#include <string_view>
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

/// Returns whether read_assemblies needs the table of a tag.
bool is_assembly_tag(const std::string& tag) {
  return gemmi::istarts_with(tag, "_pdbx_struct_assembly_gen.") ||
         gemmi::istarts_with(tag, "_pdbx_struct_oper_list.");
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
  std::uint64_t value_count = 0;  ///< number of values of loops
  bool keeps_values = false;      ///< whether the values of the current loop are kept
  std::vector<AtomSource> atoms;  ///< the rows of the table of atoms
  std::size_t rest = 0;           ///< bytes of the text from the first row of atoms on
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
      document.atoms.push_back({static_cast<std::uint32_t>(in.iterator().line)});
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

/// Returns the sources of the atoms. A table that is not a loop has one atom, in the line of its id
/// or of its first tag.
std::vector<AtomSource> sources_of(Block& block, StructureDocument& document) {
  const auto first = std::find_if(block.items.begin(), block.items.end(), is_atom_table);
  const auto is_loop = [](const Item& item) {
    return item.type == ItemType::Loop && is_atom_table(item);
  };
  const auto loop = std::find_if(block.items.begin(), block.items.end(), is_loop);
  if (loop == block.items.end()) {
    const Item* const id = block.find_pair_item("_atom_site.id");
    return {AtomSource{static_cast<std::uint32_t>(line_of(id != nullptr ? *id : *first))}};
  }
  if (std::count_if(block.items.begin(), block.items.end(), is_atom_table) > 1)
    throw MmcifError{line_of(*loop), "the _atom_site table is in several parts; join them"};
  return std::move(document.atoms);
}

/// Throws MmcifError if a table that `is_used` accepts lacks values or has the same tag twice.
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

// ------------------------------------------------------------------------------------- assemblies
//
// gemmi reads only the first factor of products of operators, such as (X0)(1-60), skips undefined
// operators, and leaves out assemblies whose `details` it does not know. For this reason, operator
// expressions are expanded here:
// https://mmcif.wwpdb.org/dictionaries/mmcif_pdbx_v50.dic/Items/_pdbx_struct_assembly_gen.oper_expression.html

using Operators = std::vector<gemmi::Assembly::Operator>;

/// Returns the text without the white space of values that span several lines.
std::string without_white_space(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](unsigned char c) { return std::isspace(c) != 0; }),
             text.end());
  return text;
}

void check_operator_count(std::size_t count, std::uint64_t line) {
  if (count > max_operators) throw MmcifError{line, too_many_operators()};
}

/// Expands operator expressions with the operators of a data block.
class OperatorTable {
 public:
  OperatorTable(gemmi::cif::Block& block, std::uint64_t line_of_expressions)
      : line_(line_of_expressions) {
    std::vector<std::string> tags{"id"};
    for (const std::string i : {"1", "2", "3"})
      for (const std::string& tag : {"matrix[" + i + "][1]", "matrix[" + i + "][2]",
                                     "matrix[" + i + "][3]", "vector[" + i + "]"})
        tags.push_back(tag);
    for (const gemmi::cif::Table::Row row : block.find("_pdbx_struct_oper_list.", tags)) {
      gemmi::Transform& transform = transforms_[row.str(0)];
      for (int i = 0; i < 3; ++i) {
        const auto number = [&](int column) {
          return gemmi::cif::as_number(row[static_cast<std::size_t>(4 * i + column)]);
        };
        for (int j = 0; j < 3; ++j) transform.mat[i][j] = number(1 + j);
        transform.vec.at(i) = number(4);
      }
    }
  }

  /// Expands an expression such as `1,2`, `(1-60)` or `(X0)(1-60)`. In a product, the operators on
  /// the right are applied first.
  Operators expand(std::string_view expression) const {
    if (expression.empty())
      throw MmcifError{line_, "the operator expression (oper_expression) is missing"};
    Operators product(1);
    std::string_view rest = expression;
    do {
      const std::size_t parentheses = !rest.empty() && rest.front() == '(' ? 1 : 0;
      const std::size_t end = parentheses == 0 ? rest.size() : rest.find(')');
      if (end == rest.npos) fail(expression, "has no closing parenthesis");
      const std::string_view factor = rest.substr(parentheses, end - parentheses);
      product = multiply(product, expand_list(factor, expression));
      rest.remove_prefix(end + parentheses);
    } while (!rest.empty());
    return product;
  }

 private:
  // Expands a list such as `1,3-5,P`.
  Operators expand_list(std::string_view list, std::string_view expression) const {
    Operators result;
    while (true) {
      const std::size_t comma = std::min(list.find(','), list.size());
      const std::string_view item = list.substr(0, comma);
      check_operator_count(result.size(), line_);
      const std::size_t minus = item.find('-');
      std::uint32_t first = 0, last = 0;
      if (minus == item.npos || !parse_integer(item.substr(0, minus), first) ||
          !parse_integer(item.substr(minus + 1), last)) {
        result.push_back(find(std::string(item), expression));
      } else if (last < first || last - first >= max_operators) {
        fail(expression, "has the invalid range " + detail::quoted(item));
      } else {
        for (std::uint32_t number = first; number <= last; ++number)
          result.push_back(find(std::to_string(number), expression));
      }
      if (comma == list.size()) return result;
      list.remove_prefix(comma + 1);
    }
  }

  gemmi::Assembly::Operator find(const std::string& name, std::string_view expression) const {
    const auto found = transforms_.find(name);
    if (found == transforms_.end())
      fail(expression,
           "has the operator " + detail::quoted(name) + ", which _pdbx_struct_oper_list lacks");
    const gemmi::Transform& transform = found->second;
    if (!std::isfinite(transform.mat.determinant() + transform.vec.length_sq()))
      fail(expression,
           "has the operator " + detail::quoted(name) + ", whose matrix is not numeric");
    return {name, {}, transform};
  }

  Operators multiply(const Operators& left, const Operators& right) const {
    check_operator_count(left.size() * right.size(), line_);
    Operators product;
    for (const gemmi::Assembly::Operator& a : left)
      for (const gemmi::Assembly::Operator& b : right)
        product.push_back({a.name + b.name, {}, a.transform.combine(b.transform)});
    return product;
  }

  [[noreturn]] void fail(std::string_view expression, const std::string& what) const {
    throw MmcifError{line_, "the operator expression " + detail::quoted(expression) + ' ' + what};
  }

  std::uint64_t line_;
  std::map<std::string, gemmi::Transform> transforms_;
};

/// Adds the assemblies to the list. `read` is the name of the assembly being read.
void add_assemblies(gemmi::cif::Block& block, const std::string& chosen,
                    std::vector<gemmi::Assembly>& assemblies, std::string& read) {
  const std::string category = "_pdbx_struct_assembly_gen.";
  gemmi::cif::Table generators =
      block.find(category, {"assembly_id", "oper_expression", "asym_id_list"});
  if (!generators.ok()) return;
  const gemmi::cif::Item* const item = block.find_values(category + "assembly_id").item();
  const auto line = static_cast<std::uint64_t>(item->line_number);
  const OperatorTable operators(block, line);
  std::size_t operator_count = 0;
  for (const gemmi::cif::Table::Row row : generators) {
    read = row.str(0);
    auto assembly = std::find_if(assemblies.begin(), assemblies.end(),
                                 [&](const gemmi::Assembly& other) { return other.name == read; });
    if (assembly == assemblies.end()) {
      assemblies.emplace_back(read);
      assembly = assemblies.end() - 1;
    }
    if (!chosen.empty() && read != chosen) continue;
    gemmi::Assembly::Gen generator;
    generator.operators = operators.expand(without_white_space(row.str(1)));
    operator_count += generator.operators.size();
    check_operator_count(operator_count, line);
    generator.subchains = gemmi::split_str(without_white_space(row.str(2)), ',');
    assembly->generators.push_back(generator);
  }
}

/// Returns the assemblies of a data block in the order of the file. Only the assembly `chosen` has
/// generators. Throws MmcifError if its operators or tables are invalid. If `chosen` is empty,
/// returns the assemblies before the first invalid one, with their generators.
std::vector<gemmi::Assembly> read_assemblies(gemmi::cif::Block& block, const std::string& chosen) {
  std::vector<gemmi::Assembly> assemblies;
  std::string read;
  try {
    check_tables(block, is_assembly_tag);
    add_assemblies(block, chosen, assemblies, read);
  } catch (const MmcifError&) {
    if (!chosen.empty()) throw;
    assemblies.erase(
        std::remove_if(assemblies.begin(), assemblies.end(),
                       [&](const gemmi::Assembly& assembly) { return assembly.name == read; }),
        assemblies.end());
  }
  return assemblies;
}

// -------------------------------------------------------------------------------------- structure

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
ParsedStructure convert(Block& block, StructureDocument& document, const ParseOptions& options) {
  ParsedStructure result;
  result.models.wanted = options.model;
  std::vector<gemmi::Assembly> assemblies = read_assemblies(block, options.assembly);
  result.sources = sources_of(block, document);
  std::vector<gemmi::Chain> chains = read_atom_table(block, options, result);
  const bool lists_subchains = block.find("_struct_asym.", {"id", "entity_id"}).ok();
  // gemmi reads the entities. It would take quadratic time for chains of many residues.
  gemmi::vector_remove_if(block.items, [](const Item& item) {
    return is_atom_table(item) || !is_needed_tag(tag_of(item));
  });
  result.structure = gemmi::make_structure_from_block(block);
  result.structure.assemblies = std::move(assemblies);
  if (chains.empty()) return result;
  result.structure.models = {make_model()};
  result.structure.models.front().chains = std::move(chains);
  set_entity_types(result.structure, lists_subchains);
  return result;
}

}  // namespace

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
