#include "input/named_part.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "input/atom_names.hpp"
#include "input/pdb_elements.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Returns whether the text of a ligand is a selection, and not a residue of NamedPart.
bool is_selection(std::string_view ligand) {
  return std::ranges::count(ligand, '/') > 1 ||
         ligand.find_first_of("([;") != std::string_view::npos;
}

/// Returns CHAIN/NUMBER of the residues that are no amino acids and nucleotides, with their names.
std::vector<std::string> numbered_ligands(std::span<const AtomLabel> labels) {
  std::vector<std::string> names;
  for (const AtomLabel& label : residue_runs(labels).labels)
    if (!is_named_polymer(label.residue))
      names.push_back(formatted("{}/{} ({})", label.chain, label.residue_number, label.residue));
  return names;
}

/// Returns a hint about a name or number without a chain: a residue that it may have meant.
std::string advice_for_name(std::span<const AtomLabel> labels, const std::string& name) {
  for (const AtomLabel& label : labels) {
    if (lower_case(label.residue) == lower_case(name))
      return formatted("; did you mean {}?", label.residue);
    if (label.residue_number == name)
      return formatted("; residue {1} is ligand:{0}/{1}", label.chain, name);
  }
  return "";
}

/// Returns a hint about a chain with a name or number: a residue that they may have meant.
std::string advice_for_chain_and_name(std::span<const AtomLabel> labels,
                                      const std::string& residue) {
  const std::size_t slash = residue.find('/');
  const std::string chain = lower_case(residue.substr(0, slash));
  const std::string name = lower_case(residue.substr(slash + 1));
  const AtomLabel* found = nullptr;
  for (const AtomLabel& label : labels) {
    if (lower_case(label.residue) != name && lower_case(label.residue_number) != name) continue;
    const bool is_in_chain = lower_case(label.chain) == chain;
    if (found == nullptr || is_in_chain) found = &label;
    if (is_in_chain) break;
  }
  if (found == nullptr) return "";
  return formatted("; did you mean {}/{}?", found->chain,
                   lower_case(found->residue) == name ? found->residue : found->residue_number);
}

}  // namespace

bool NamedPart::has_residue(std::string_view chain, std::string_view number,
                            std::string_view name) const {
  if (residue.empty()) return std::ranges::find(chains, chain) != chains.end();
  const std::size_t slash = residue.find('/');
  if (slash == std::string::npos) return name == residue;
  const std::string_view wanted = std::string_view(residue).substr(slash + 1);
  return chain == std::string_view(residue).substr(0, slash) &&
         (number == wanted || name == wanted);
}

std::vector<bool> NamedPart::atoms_in(std::span<const AtomLabel> labels) const {
  std::vector<bool> is_in;
  is_in.reserve(labels.size());
  for (const AtomLabel& label : labels)
    is_in.push_back(has_residue(label.chain, label.residue_number, label.residue));
  return is_in;
}

std::optional<NamedPart> ligand_part(std::string_view text) {
  if (text == all_ligands_text) return NamedPart{.all_ligands = true};
  if (!text.starts_with(ligand_prefix) || text == ligand_prefix) return std::nullopt;
  std::string ligand(text.substr(ligand_prefix.size()));
  if (is_selection(ligand)) return NamedPart{.selection = std::move(ligand)};
  return NamedPart{.residue = std::move(ligand)};
}

std::vector<std::string> names_in_list(std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t end = 0; end != std::string_view::npos; text.remove_prefix(end + 1)) {
    end = text.find_first_of("+,");
    names.emplace_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) break;
  }
  return names;
}

NamedPart named_part(std::string_view text, const std::set<std::string>& known_chains) {
  std::vector<std::string> names = names_in_list(text);
  if (std::ranges::all_of(names, [&](const auto& name) { return known_chains.contains(name); }))
    return {.chains = std::move(names)};
  return ligand_part(text).value_or(NamedPart{.selection = std::string(text)});
}

std::vector<std::string> different_names(std::span<const AtomLabel> labels,
                                         std::string AtomLabel::*name) {
  std::vector<std::string> names;
  std::set<std::string_view> seen;
  for (const AtomLabel& label : labels)
    if (seen.insert(label.*name).second) names.push_back(label.*name);
  return names;
}

std::string first_names(const std::vector<std::string>& names) {
  return first_texts(names, 10, [](const std::string& name) {
    return name.empty() ? "(blank)" : printable(name);
  });
}

std::string unknown_residue_text(std::span<const AtomLabel> labels, const std::string& residue,
                                 std::string_view origin) {
  const bool has_chain = residue.find('/') != std::string::npos;
  const std::vector<std::string> numbered =
      has_chain ? numbered_ligands(labels) : std::vector<std::string>();
  if (!numbered.empty())
    return formatted("no atoms of ligand {}{}; the ligands are {}{}", printable(residue), origin,
                     first_names(numbered), advice_for_chain_and_name(labels, residue));
  std::vector<std::string> names = different_names(labels, &AtomLabel::residue);
  std::stable_partition(names.begin(), names.end(),
                        [](const std::string& name) { return !is_named_polymer(name); });
  return formatted("no atoms of residue {}{}; the residues are {}{}", printable(residue), origin,
                   first_names(names), advice_for_name(labels, residue));
}

std::vector<bool> require_atoms(const NamedPart& part, std::span<const AtomLabel> labels) {
  std::vector<bool> is_in = part.atoms_in(labels);
  if (!part.residue.empty() && std::ranges::find(is_in, true) == is_in.end())
    throw Error("selection: " + unknown_residue_text(labels, part.residue));
  return is_in;
}

}  // namespace eses::detail
