#include "input/structure/select_atoms.hpp"

#include <algorithm>
#include <gemmi/modify.hpp>
#include <gemmi/select.hpp>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/select_atoms.hpp"
#include "input/named_part.hpp"
#include "input/structure/selection.hpp"
#include "input/structure/structure_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Calls `remove` and returns the number of atoms that it has removed from the model.
std::uint64_t dropped_by(const gemmi::Model& model, const auto& remove) {
  const std::uint64_t before = count_atoms(model);
  remove();
  return before - count_atoms(model);
}

void remove_residues(gemmi::Model& model, const auto& is_removed) {
  for (gemmi::Chain& chain : model.chains) gemmi::vector_remove_if(chain.residues, is_removed);
}

void keep_chains(gemmi::Model& model, const std::vector<std::string>& names,
                 const std::set<std::string>& known, std::string_view file) {
  if (names.empty()) return;
  for (const std::string& name : names)
    if (!known.contains(name))
      throw Error(formatted("{}: there is no chain {} (--chains); {}", file, detail::quoted(name),
                            chains_text(known)));
  gemmi::vector_remove_if(model.chains, [&](const gemmi::Chain& chain) {
    return !gemmi::in_vector(chain.name, names);
  });
}

/// The label of an atom and its index in the file.
using IndexedLabel = std::pair<int, AtomLabel>;

/// Returns the labels of the atoms in the order of the file.
std::vector<IndexedLabel> labels_of(const gemmi::Model& model) {
  std::vector<IndexedLabel> atoms;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      for (const gemmi::Atom& atom : residue.atoms)
        atoms.push_back(
            {atom.serial,
             {chain.name, residue.name, residue.seqid.str(), atom.name, atom.element.name()}});
  std::ranges::stable_sort(atoms, {}, &IndexedLabel::first);
  return atoms;
}

std::vector<AtomLabel> without_indices(const std::vector<IndexedLabel>& atoms) {
  std::vector<AtomLabel> labels;
  for (const auto& [serial, label] : atoms) labels.push_back(label);
  return labels;
}

/// Keeps the atoms of all ligands, which follow from the names of the atoms in the order of the
/// file.
void keep_ligands(gemmi::Model& model) {
  const std::vector<IndexedLabel> atoms = labels_of(model);
  const std::vector<bool> are_ligands = find_ligand_atoms(without_indices(atoms));
  std::set<int> kept;
  for (std::size_t i = 0; i < atoms.size(); ++i)
    if (are_ligands[i]) kept.insert(atoms[i].first);
  for (gemmi::Chain& chain : model.chains)
    for (gemmi::Residue& residue : chain.residues)
      gemmi::vector_remove_if(residue.atoms,
                              [&](const gemmi::Atom& atom) { return !kept.contains(atom.serial); });
}

/// Keeps the residues of a part of chains or of a residue. Throws EmptyPart if there are none.
void keep_named(gemmi::Model& model, const NamedPart& part, std::string_view option) {
  const auto is_in = [&part](const gemmi::Chain& chain, const gemmi::Residue& residue) {
    return part.has_residue(chain.name, residue.seqid.str(), residue.name);
  };
  const bool has_any = std::ranges::any_of(model.chains, [&](const gemmi::Chain& chain) {
    return std::ranges::any_of(chain.residues,
                               [&](const auto& each) { return is_in(chain, each); });
  });
  if (!has_any && !part.residue.empty())
    throw EmptyPart(formatted(
        "{}: {}", option, unknown_residue_text(without_indices(labels_of(model)), part.residue)));
  for (gemmi::Chain& chain : model.chains)
    gemmi::vector_remove_if(chain.residues,
                            [&](const gemmi::Residue& each) { return !is_in(chain, each); });
}

/// Keeps the atoms of a selection in gemmi's syntax. Throws EmptyPart if there are none, although
/// the model has all chains of the file.
void keep_selection(ParsedStructure& parsed, const std::string& text,
                    const std::set<std::string>& chains, bool has_all_chains,
                    std::string_view file) {
  gemmi::Model& model = parsed.structure.models.front();
  const std::string option = formatted("{}: selection", file);
  const gemmi::Selection selection = parse_selection(text, option);
  const std::string& name = parsed.models.chosen;
  if (selection.mdl != 0 && std::to_string(selection.mdl) != name)
    throw Error(formatted("{}: the selection names model {}, but model {} is read; use --model {}",
                          file, selection.mdl, printable(name), selection.mdl));
  refuse_words(selection, text, chains, option);
  if (!selection.entity_types.all) complete_entity_types(model, parsed.structure.input_format);
  selection.remove_not_selected(model);
  if (has_all_chains && count_atoms(model) == 0)
    throw EmptyPart(
        formatted("{}: no atoms of {}; {}", option, printable(text), chains_text(chains)));
}

void keep_selected(ParsedStructure& parsed, const StructureOptions& options,
                   const std::set<std::string>& chains, std::string_view file) {
  if (options.select.empty()) return;
  gemmi::Model& model = parsed.structure.models.front();
  const NamedPart part = named_part(options.select, chains);
  if (part.all_ligands)
    keep_ligands(model);
  else if (part.selection.empty())
    keep_named(model, part, formatted("{}: selection", file));
  else
    keep_selection(parsed, part.selection, chains, options.chains.empty(), file);
}

/// Removes dummy atoms, by which programs mark missing atoms: without occupancy, far from all
/// others.
void remove_dummies(gemmi::Model& model) {
  constexpr double dummy_coordinate = 9999;  // angstrom, the largest one that fits the columns
  for (gemmi::Chain& chain : model.chains)
    for (gemmi::Residue& residue : chain.residues)
      gemmi::vector_remove_if(residue.atoms, [](const gemmi::Atom& atom) {
        return atom.occ == 0 && std::min({atom.pos.x, atom.pos.y, atom.pos.z}) >= dummy_coordinate;
      });
}

// --------------------------------------------------------------------------- alternate locations

/// Residues of a chain with the same number and with alternate locations. Several residues are
/// alternatives.
using ResidueGroup = std::vector<gemmi::Residue*>;

bool has_altloc(const gemmi::Atom& atom) { return atom.altloc != '\0'; }

/// Returns the groups by chain, segment and number. The residues of a group need not be neighbours:
/// a modified residue may come after the end of its chain.
auto residue_groups(gemmi::Model& model) {
  std::map<std::tuple<std::string, std::string, std::string>, ResidueGroup> groups;
  for (gemmi::Chain& chain : model.chains)
    for (gemmi::Residue& residue : chain.residues)
      if (std::any_of(residue.atoms.begin(), residue.atoms.end(), has_altloc))
        groups[{chain.name, residue.segment, residue.seqid.str()}].push_back(&residue);
  return groups;
}

/// The occupancies of locations by their letters; the location without a letter has the key 0.
using Locations = std::map<char, double>;

/// Returns the mean occupancy of each alternate location.
Locations mean_occupancies(const ResidueGroup& group) {
  std::map<char, std::pair<double, double>> sums;
  for (const gemmi::Residue* residue : group)
    for (const gemmi::Atom& atom : residue->atoms)
      if (has_altloc(atom)) {
        auto& [sum, count] = sums[atom.altloc];
        sum += static_cast<double>(atom.occ);
        ++count;
      }
  Locations means;
  for (const auto& [altloc, sum] : sums) means[altloc] = sum.first / sum.second;
  return means;
}

/// Returns the location with the highest occupancy, or the first one of several; 0 if there is
/// none.
char best_altloc(const Locations& occupancies) {
  constexpr double equal_occupancies = 1e-5;  // files have two or three decimals
  char best = '\0';
  double highest = -std::numeric_limits<double>::infinity();
  for (const auto& [altloc, occupancy] : occupancies)
    if (occupancy > highest + equal_occupancies) {
      best = altloc;
      highest = occupancy;
    }
  return best;
}

/// Returns whether the location without a letter is an alternative to those with one. Otherwise,
/// the occupancies of two atoms with the same name add up to more than 1.
bool is_blank_alternative(const Locations& locations) {
  constexpr double max_sum = 1.01;  // files have two decimals
  double sum = 0;
  for (const auto& [altloc, occupancy] : locations) sum += occupancy;
  return sum <= max_sum;
}

/// Returns the location to keep: `wanted` or else, if the atom has a location without a letter, the
/// one with the highest occupancy; or else `best` or the one with the highest occupancy.
char kept_location(const Locations& locations, char wanted, char best) {
  if (wanted != '\0' && locations.contains(wanted)) return wanted;
  return locations.contains(best) && !locations.contains('\0') ? best : best_altloc(locations);
}

/// Keeps one location of each atom.
void keep_altloc(gemmi::Residue& residue, char wanted, char best) {
  std::map<std::string, Locations> by_name;
  for (const gemmi::Atom& atom : residue.atoms)
    by_name[atom.name].emplace(atom.altloc, static_cast<double>(atom.occ));
  std::map<std::string, char> kept;
  std::set<std::string> with_two_atoms;
  for (auto& [name, locations] : by_name) {
    if (locations.size() > 1 && locations.contains('\0') && !is_blank_alternative(locations)) {
      with_two_atoms.insert(name);
      locations.erase('\0');
    }
    kept[name] = kept_location(locations, wanted, best);
  }
  gemmi::vector_remove_if(residue.atoms, [&](const gemmi::Atom& atom) {
    if (!has_altloc(atom) && with_two_atoms.contains(atom.name)) return false;
    return atom.altloc != kept[atom.name];
  });
}

/// Returns whether a residue is one of several alternatives, and not the chosen one.
bool is_other_residue(const ResidueGroup& group, const gemmi::Residue& residue, char chosen) {
  return group.size() > 1 &&
         std::all_of(residue.atoms.begin(), residue.atoms.end(), [&](const gemmi::Atom& atom) {
           return has_altloc(atom) && atom.altloc != chosen;
         });
}

void keep_altlocs(gemmi::Model& model, const std::string& wanted, std::string_view file) {
  const char altloc = wanted.empty() ? '\0' : wanted.front();
  bool is_known = wanted.empty();
  for (const auto& [id, group] : residue_groups(model)) {
    const Locations occupancies = mean_occupancies(group);
    const bool has_wanted = occupancies.contains(altloc);
    is_known = is_known || has_wanted;
    const char best = best_altloc(occupancies);
    for (gemmi::Residue* residue : group) {
      if (is_other_residue(group, *residue, has_wanted ? altloc : best))
        residue->atoms.clear();
      else
        keep_altloc(*residue, altloc, best);
    }
  }
  if (!is_known)
    throw Error(
        formatted("{}: no atom has the alternate location {} (--altloc)", file, printable(wanted)));
}

void count_kept(const gemmi::Model& model, StructureReport& report) {
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      record_count(report, residue) += residue.atoms.size();
}

}  // namespace

bool is_water(const gemmi::Residue& residue) {
  return is_water_residue(residue.name, residue.atoms, [](const gemmi::Atom& atom) {
    return std::pair(atom.name, std::string(symbol_of(atom.element)));
  });
}

std::uint64_t& record_count(StructureReport& report, const gemmi::Residue& residue) {
  if (is_water(residue)) return report.waters;
  return is_hetatm(residue) ? report.hetatm_records : report.atom_records;
}

void select_atoms(ParsedStructure& parsed, const StructureOptions& options, bool with_hydrogens,
                  std::string_view file, StructureReport& report) {
  gemmi::Model& model = parsed.structure.models.front();
  report.model = parsed.models.chosen;
  report.models = parsed.models.names.size();
  const std::set<std::string> chains = chain_names(model);
  report.dropped_dummies = dropped_by(model, [&] { remove_dummies(model); });
  report.dropped_chains =
      dropped_by(model, [&] { keep_chains(model, options.chains, chains, file); });
  report.dropped_selection =
      dropped_by(model, [&] { keep_selected(parsed, options, chains, file); });
  if (!options.with_waters)
    report.dropped_waters = dropped_by(model, [&] { remove_residues(model, is_water); });
  if (!options.with_hetatm)
    report.dropped_hetatm = dropped_by(model, [&] {
      remove_residues(model, [](const gemmi::Residue& residue) {
        return is_hetatm(residue) && !is_water(residue);
      });
    });
  if (!with_hydrogens)
    report.dropped_hydrogens = dropped_by(model, [&] { gemmi::remove_hydrogens(model); });
  report.dropped_altlocs = dropped_by(model, [&] { keep_altlocs(model, options.altloc, file); });
  gemmi::remove_empty_children(model);
  count_kept(model, report);
}

}  // namespace eses::detail
