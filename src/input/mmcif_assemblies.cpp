// This file is valid C++17, for the reason given in mmcif_text.cpp.
//
// gemmi 0.5 reads only the first factor of products of operators, such as (X0)(1-60), skips
// undefined operators, and leaves out assemblies whose `details` it does not know. For this reason,
// operator expressions are expanded here:
// https://mmcif.wwpdb.org/dictionaries/mmcif_pdbx_v50.dic/Items/_pdbx_struct_assembly_gen.oper_expression.html

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <map>
#include <string_view>

#include "input/mmcif_tables.hpp"
#include "input/parse_structure.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

using Operators = std::vector<gemmi::Assembly::Operator>;

/// Returns the text without the white space of values that span several lines.
std::string without_white_space(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](unsigned char c) { return std::isspace(c) != 0; }),
             text.end());
  return text;
}

bool is_finite(const gemmi::Transform& transform) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(transform.vec.at(i))) return false;
    for (int j = 0; j < 3; ++j)
      if (!std::isfinite(transform.mat[i][j])) return false;
  }
  return true;
}

std::uint64_t line_of(const gemmi::cif::Table& table) {
  const gemmi::cif::Item& item =
      table.loop_item != nullptr
          ? *table.loop_item
          : table.bloc.items.at(static_cast<std::size_t>(table.positions.at(0)));
  return static_cast<std::uint64_t>(item.line_number);
}

void check_operator_count(std::size_t count, std::uint64_t line) {
  if (count > max_operators) throw MmcifError{line, too_many_operators()};
}

/// Expands operator expressions with the operators of a data block.
class OperatorTable {
 public:
  OperatorTable(gemmi::cif::Block& block, std::uint64_t line_of_expressions)
      : line_(line_of_expressions) {
    std::vector<std::string> tags = gemmi::impl::transform_tags("matrix", "vector");
    const int id = static_cast<int>(tags.size());
    tags.emplace_back("id");
    for (const gemmi::cif::Table::Row row : block.find("_pdbx_struct_oper_list.", tags))
      transforms_[row.str(id)] = gemmi::impl::get_transform_matrix(row);
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
      std::uint32_t first = 0, last = 0;
      if (!parse_range(item, first, last)) {
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

  static bool parse_range(std::string_view item, std::uint32_t& first, std::uint32_t& last) {
    const std::size_t minus = item.find('-');
    return minus != item.npos && parse_integer(item.substr(0, minus), first) &&
           parse_integer(item.substr(minus + 1), last);
  }

  gemmi::Assembly::Operator find(const std::string& name, std::string_view expression) const {
    const auto found = transforms_.find(name);
    const bool is_known = found != transforms_.end();
    if (!is_known || !is_finite(found->second))
      fail(expression, "has the operator " + detail::quoted(name) +
                           (is_known ? ", whose matrix is not numeric"
                                     : ", which _pdbx_struct_oper_list lacks"));
    return {name, {}, found->second};
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
  gemmi::cif::Table generators =
      block.find("_pdbx_struct_assembly_gen.", {"assembly_id", "oper_expression", "asym_id_list"});
  if (!generators.ok()) return;
  const std::uint64_t line = line_of(generators);
  const OperatorTable operators(block, line);
  std::size_t operator_count = 0;
  for (const gemmi::cif::Table::Row row : generators) {
    gemmi::Assembly& assembly = gemmi::impl::find_or_add(assemblies, row.str(0));
    read = assembly.name;
    if (!chosen.empty() && assembly.name != chosen) continue;
    gemmi::Assembly::Gen generator;
    generator.operators = operators.expand(without_white_space(row.str(1)));
    operator_count += generator.operators.size();
    check_operator_count(operator_count, line);
    gemmi::split_str_into(without_white_space(row.str(2)), ',', generator.subchains);
    assembly.generators.push_back(generator);
  }
}

}  // namespace

bool is_assembly_table(const gemmi::cif::Item& item) {
  return item.has_prefix("_pdbx_struct_assembly_gen.") ||
         item.has_prefix("_pdbx_struct_oper_list.");
}

std::vector<gemmi::Assembly> read_assemblies(gemmi::cif::Block& block, const std::string& chosen) {
  std::vector<gemmi::Assembly> assemblies;
  std::string read;
  try {
    check_tables(block, is_assembly_table);
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

}  // namespace eses::detail
