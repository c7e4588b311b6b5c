#include <algorithm>
#include <cstddef>
#include <gemmi/model.hpp>
#include <gemmi/resinfo.hpp>
#include <gemmi/select.hpp>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/named_part.hpp"
#include "input/pdb_elements.hpp"
#include "input/residue_runs.hpp"
#include "input/structure/parse_structure.hpp"
#include "input/structure/select_atoms.hpp"
#include "input/structure/selection.hpp"
#include "input/structure/structure_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses {
namespace detail {
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
}  // namespace detail

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
