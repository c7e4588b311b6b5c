// Selections in gemmi's syntax, and their atoms in labels: the functions of eses/select_atoms.hpp.

#include "input/structure/selection.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <gemmi/model.hpp>
#include <gemmi/polyheur.hpp>
#include <gemmi/resinfo.hpp>
#include <gemmi/select.hpp>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/atom_names.hpp"
#include "input/named_part.hpp"
#include "input/pdb_elements.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/structure/select_atoms.hpp"
#include "input/structure/structure_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Returns gemmi's message in the style of this program: one line that starts in lower case.
std::string reworded(std::string_view text) {
  while (text.ends_with('.') || text.ends_with(':') || text.ends_with(' ') || text.ends_with('\n'))
    text.remove_suffix(1);
  std::string message(text);
  std::replace(message.begin(), message.end(), '\n', ' ');
  if (!message.empty()) message[0] = lower_case(message[0]);
  return printable(message);
}

using ResidueNumber = gemmi::Selection::SequenceId;

/// Removes the number at the start of a text, such as -3, 52A or 52.A, and returns it.
std::optional<ResidueNumber> take_number(std::string_view& text) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  std::size_t length = sign;
  while (length < text.size() && is_digit(text[length])) ++length;
  int number = 0;
  if (!parse_integer(text.substr(0, length), number)) return std::nullopt;
  text.remove_prefix(length);
  ResidueNumber result{number, '*'};
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    result.icode = ' ';
  }
  if (!text.empty() && is_letter(text.front())) {
    result.icode = text.front();
    text.remove_prefix(1);
  }
  return result;
}

/// Numbers of the first and the last residue of a range.
struct ResidueRange {
  ResidueNumber first, last;
};

/// Returns the range of a field of residues that has a negative number, which old versions of gemmi
/// misread: -3, -3--1, -3-5 or -3-.
std::optional<ResidueRange> negative_range(std::string_view field) {
  if (!field.starts_with('-') && field.find("--") == std::string_view::npos) return std::nullopt;
  const std::optional<ResidueNumber> first = take_number(field);
  if (!first) return std::nullopt;
  ResidueRange range{*first, *first};
  if (field.starts_with('-')) {
    field.remove_prefix(1);
    range.last = take_number(field).value_or(gemmi::Selection().to_seqid);
  }
  return field.empty() ? std::optional(range) : std::nullopt;
}

/// Returns the part of a selection that names residues: the field after that of the chain. A text
/// that begins with a number has no chain.
std::string_view residue_field(std::string_view text) {
  const bool is_number = !text.empty() && (is_digit(text.front()) || text.front() == '-');
  const int fields_before = text.starts_with('/') ? 3 : (is_number ? 0 : 1);
  for (int k = 0; k < fields_before; ++k) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) return {};
    text.remove_prefix(slash + 1);
  }
  return text.substr(0, text.find_first_of("/;"));
}

}  // namespace

std::set<std::string> chain_names(const gemmi::Model& model) {
  std::set<std::string> names;
  for (const gemmi::Chain& chain : model.chains) names.insert(chain.name);
  return names;
}

std::string chains_text(const std::set<std::string>& chains) {
  std::vector<std::string> names;
  for (const std::string& name : chains)
    if (!name.empty()) names.push_back(printable(name));
  const bool has_nameless = names.size() < chains.size();
  if (names.empty()) return "its atoms have no chain names";
  return formatted("its chains are {}{}", fmt::join(names, ", "),
                   has_nameless ? "; other atoms have no chain name" : "");
}

gemmi::Selection parse_selection(const std::string& text, std::string_view option) {
  try {
    const std::string_view residues = residue_field(text);
    if (const std::optional<ResidueRange> range = negative_range(residues)) {
      std::string others = text;
      others.erase(static_cast<std::size_t>(residues.data() - text.data()), residues.size());
      gemmi::Selection selection{others};
      selection.from_seqid = range->first;
      selection.to_seqid = range->last;
      return selection;
    }
    gemmi::Selection selection{text};
    // Old versions of gemmi take a single residue, as in A/57, for the begin of a range.
    const bool is_range = residues.find('-') != std::string_view::npos;
    if (!selection.from_seqid.empty() && !is_range) selection.to_seqid = selection.from_seqid;
    return selection;
  } catch (const std::exception& error) {
    throw Error(formatted("{}: {}", option, reworded(error.what())));
  }
}

void refuse_words(const gemmi::Selection& selection, const std::string& text,
                  const std::set<std::string>& known, std::string_view option) {
  if (text != selection.chain_ids.list || selection.chain_ids.inverted) return;
  const std::vector<std::string> names = names_in_list(text);
  const auto missing =
      std::ranges::find_if(names, [&](const auto& name) { return !known.contains(name); });
  if (missing == names.end()) return;
  const bool is_list = names.size() > 1 && std::ranges::none_of(names, [](const auto& name) {
                         return name.empty() || name.find(' ') != std::string::npos;
                       });
  if (is_list)
    throw Error(
        formatted("{}: no atoms of chain {}; {}", option, printable(*missing), chains_text(known)));
  throw Error(
      formatted("{}: invalid selection syntax, expected the name of a chain or a "
                "selection such as //A/10-20, found {}; {}",
                option, detail::quoted(text), chains_text(known)));
}

void complete_entity_types(gemmi::Model& model, gemmi::CoorFormat format) {
  using gemmi::EntityType;
  for (gemmi::Chain& chain : model.chains) {
    for (gemmi::Residue& residue : chain.residues) {
      const bool is_unknown =
          residue.entity_type == EntityType::Unknown ||
          (format == gemmi::CoorFormat::Pdb && residue.entity_type == EntityType::NonPolymer);
      if (is_unknown && !is_hetatm(residue) && is_polymer_residue(residue.name))
        residue.entity_type = EntityType::Polymer;
    }
    gemmi::add_entity_types(chain, false);
  }
}

namespace {

/// Throws Error if the selection names what labels do not have.
void require_labels(const gemmi::Selection& selection, const std::string& text) {
  const char* missing = selection.mdl != 0                     ? "models"
                        : !selection.altlocs.all               ? "alternate locations"
                        : !selection.atom_inequalities.empty() ? "occupancies and B-factors"
                                                               : nullptr;
  if (missing != nullptr)
    throw Error(
        formatted("selection {}: {} cannot be selected here", detail::quoted(text), missing));
}

/// Returns the residue number and insertion code of a text such as 52A; 0 for other texts.
gemmi::SeqId sequence_id(const std::string& text) {
  const std::size_t end = text.find_first_not_of("0123456789", text.starts_with('-') ? 1 : 0);
  int number = 0;
  if (!parse_integer(std::string_view(text).substr(0, end), number)) return {0, ' '};
  return {number, end == std::string::npos ? ' ' : text[end]};
}

/// Returns a model whose atoms have their indices as serial numbers.
gemmi::Model model_of(std::span<const AtomLabel> atoms) {
  std::vector<AtomLabel> labels(atoms.begin(), atoms.end());
  complete_elements(labels);
  gemmi::Model model = make_model();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const AtomLabel& label = labels[i];
    const bool is_new_chain = i == 0 || labels[i - 1].chain != label.chain;
    if (is_new_chain) model.chains.emplace_back(label.chain);
    if (is_new_chain || !detail::is_same_residue(labels[i - 1], label)) {
      gemmi::Residue& residue = model.chains.back().residues.emplace_back();
      residue.name = label.residue;
      residue.seqid = sequence_id(label.residue_number);
    }
    gemmi::Atom& atom = model.chains.back().residues.back().atoms.emplace_back();
    atom.name = label.atom_name;
    atom.element = gemmi::Element(label.element);
    atom.serial = static_cast<int>(i);
  }
  return model;
}

/// Returns whether a residue may be one of a polymer, as gemmi decides.
bool may_be_of_polymer(const gemmi::Residue& residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(residue.name);
  return is_polymer_residue(residue.name) || info.is_amino_acid() || info.is_nucleic_acid() ||
         residue.get_ca() != nullptr || residue.get_p() != nullptr;
}

/// Sets the entity types of the residues of a model. A chain is a polymer if most of its first
/// residues are. Waters and ligands do not count, because some files have many of them in the chain
/// of the polymer. Changes the order of the residues.
void set_entity_types(gemmi::Model& model) {
  model.merge_chain_parts();  // ligands and waters often follow the last chain
  std::vector<std::vector<gemmi::Residue>> others;
  for (gemmi::Chain& chain : model.chains) {
    std::vector<gemmi::Residue>& residues = chain.residues;
    const auto waters =
        std::stable_partition(residues.begin(), residues.end(),
                              [](const gemmi::Residue& residue) { return !is_water(residue); });
    const auto end = std::find_if_not(residues.begin(), waters, may_be_of_polymer);
    for (auto residue = end; residue != residues.end(); ++residue)
      residue->entity_type = residue >= waters                   ? gemmi::EntityType::Water
                             : is_polymer_residue(residue->name) ? gemmi::EntityType::Polymer
                                                                 : gemmi::EntityType::NonPolymer;
    others.emplace_back(std::make_move_iterator(end), std::make_move_iterator(residues.end()));
    residues.erase(end, residues.end());
  }
  complete_entity_types(model, gemmi::CoorFormat::Mmcif);
  for (std::size_t i = 0; i < others.size(); ++i)
    std::move(others[i].begin(), others[i].end(), std::back_inserter(model.chains[i].residues));
}

/// Returns whether each of so many atoms is in a residue of the model that `is_chosen` accepts.
std::vector<bool> atoms_of(const gemmi::Model& model, std::size_t count, const auto& is_chosen) {
  std::vector<bool> found(count);
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      if (is_chosen(residue))
        for (const gemmi::Atom& atom : residue.atoms)
          found[static_cast<std::size_t>(atom.serial)] = true;
  return found;
}

}  // namespace
}  // namespace eses::detail

namespace eses {

std::vector<bool> select_atoms(std::span<const AtomLabel> atoms, const std::string& selection) {
  gemmi::Model model = detail::model_of(atoms);
  const std::set<std::string> chains = detail::chain_names(model);
  const detail::NamedPart part = detail::named_part(selection, chains);
  if (part.all_ligands) return find_ligand_atoms(atoms);
  if (part.selection.empty()) return detail::require_atoms(part, atoms);
  const gemmi::Selection parsed = detail::parse_selection(part.selection, "selection");
  detail::require_labels(parsed, part.selection);
  detail::refuse_words(parsed, part.selection, chains, "selection");
  if (!parsed.entity_types.all) detail::set_entity_types(model);
  parsed.remove_not_selected(model);
  return detail::atoms_of(model, atoms.size(), [](const gemmi::Residue&) { return true; });
}

std::vector<bool> find_ligand_atoms(std::span<const AtomLabel> atoms) {
  gemmi::Model model = detail::model_of(atoms);
  detail::set_entity_types(model);
  return detail::atoms_of(model, atoms.size(), [](const gemmi::Residue& residue) {
    std::set<std::string_view> heavy_atoms;  // names, because an atom may have alternate locations
    for (const gemmi::Atom& atom : residue.atoms)
      if (!atom.is_hydrogen()) heavy_atoms.insert(atom.name);
    return residue.entity_type == gemmi::EntityType::NonPolymer && heavy_atoms.size() > 1 &&
           !detail::is_water(residue);
  });
}

}  // namespace eses
