// This file is valid C++17. Clang 14 cannot compile it as C++20, because the CIF documents of gemmi
// 0.5 have vectors of an incomplete type.

#include "structure/mmcif_text.hpp"

#include <cstddef>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <new>
#include <vector>

namespace eses::detail {
namespace {

/// A document with the line numbers of the rows of the table of atoms.
struct NumberedDocument : gemmi::cif::Document {
  explicit NumberedDocument(Checker& its_checker) : checker(its_checker) {}

  Checker& checker;
  std::vector<std::uint64_t> atom_lines;
};

constexpr std::string_view atom_category = "_atom_site.";

bool starts_with(std::string_view text, std::string_view prefix) {
  return text.substr(0, prefix.size()) == prefix;
}

template <class Rule>
struct NumberingAction : gemmi::cif::Action<Rule> {};

template <>
struct NumberingAction<gemmi::cif::rules::loop_value> {
  template <class Input>
  static void apply(const Input& in, NumberedDocument& document) {
    document.checker.count();
    const gemmi::cif::Loop& loop = document.items_->back().loop;
    if (loop.values.size() % loop.tags.size() == 0 && starts_with(loop.tags.front(), atom_category))
      document.atom_lines.push_back(in.iterator().line);
    gemmi::cif::Action<gemmi::cif::rules::loop_value>::apply(in, document);
  }
};

/// Replaces the serial numbers of atoms by their line numbers. Removes anisotropic displacements,
/// which refer to the original serial numbers.
void number_atoms(NumberedDocument& document) {
  std::size_t row = 0;
  for (gemmi::cif::Block& block : document.blocks) {
    for (gemmi::cif::Item& item : block.items) {
      // A table of one atom need not be a loop.
      if (item.type == gemmi::cif::ItemType::Pair && item.pair[0] == "_atom_site.id")
        item.pair[1] = std::to_string(item.line_number);
      if (item.type != gemmi::cif::ItemType::Loop || item.loop.tags.empty()) continue;
      gemmi::cif::Loop& loop = item.loop;
      if (starts_with(loop.tags.front(), "_atom_site_anisotrop.")) {
        item.erase();
        continue;
      }
      if (!starts_with(loop.tags.front(), atom_category)) continue;
      const std::size_t rows = loop.length();
      if (const int id = loop.find_tag("_atom_site.id"); id >= 0)
        for (std::size_t i = 0; i < rows && row + i < document.atom_lines.size(); ++i)
          loop.values[i * loop.width() + static_cast<std::size_t>(id)] =
              std::to_string(document.atom_lines[row + i]);
      row += rows;
    }
  }
}

}  // namespace

gemmi::Structure parse_mmcif_text(std::string_view text, const std::string& name,
                                  Checker& checker) {
  try {
    NumberedDocument document(checker);
    document.source = name;
    gemmi::cif::pegtl::memory_input<> in(text.data(), text.size(), name);
    gemmi::cif::pegtl::parse<gemmi::cif::rules::file, NumberingAction, gemmi::cif::Errors>(
        in, document);
    gemmi::cif::check_for_missing_values(document);
    gemmi::cif::check_for_duplicates(document);
    checker.check();
    number_atoms(document);
    checker.check();
    return gemmi::make_structure(document);
  } catch (const tao::pegtl::parse_error& error) {
    throw MmcifError{error.positions().front().line, std::string(error.message())};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw MmcifError{0, error.what()};
  }
}

}  // namespace eses::detail
