// This file is valid C++17, for the reason given in mmcif_text.cpp.
//
// gemmi reads only the first factor of products of operators, such as (X0)(1-60), skips undefined
// operators, and leaves out assemblies whose `details` it does not know. For this reason, operator
// expressions are expanded here:
// https://mmcif.wwpdb.org/dictionaries/mmcif_pdbx_v50.dic/Items/_pdbx_struct_assembly_gen.oper_expression.html

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gemmi/numb.hpp>
#include <map>
#include <string_view>

#include "input/structure/mmcif_tables.hpp"
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

}  // namespace

bool is_assembly_tag(const std::string& tag) {
  return gemmi::istarts_with(tag, "_pdbx_struct_assembly_gen.") ||
         gemmi::istarts_with(tag, "_pdbx_struct_oper_list.");
}

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

}  // namespace eses::detail
