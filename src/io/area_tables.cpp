#include "io/area_tables.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <unordered_map>

namespace eses {
namespace {

std::string field(std::string_view text) {
  if (text.find_first_of(",\"") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

bool is_same_residue(const ResidueArea& residue, const AtomLabel& label) {
  return residue.chain == label.chain && residue.number == label.residue_number &&
         residue.name == label.residue;
}

}  // namespace

std::vector<ResidueArea> areas_by_residue(std::span<const AtomLabel> labels,
                                          std::span<const double> areas) {
  std::vector<ResidueArea> residues;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const AtomLabel& label = labels[i];
    if (residues.empty() || !is_same_residue(residues.back(), label))
      residues.push_back({label.chain, label.residue_number, label.residue, 0, 0});
    ++residues.back().atoms;
    residues.back().area += areas[i];
  }
  return residues;
}

std::vector<ChainArea> areas_by_chain(std::span<const ResidueArea> residues) {
  std::vector<ChainArea> chains;
  std::unordered_map<std::string_view, std::size_t> places;
  for (const ResidueArea& residue : residues) {
    const auto [place, is_new] = places.try_emplace(residue.chain, chains.size());
    if (is_new) chains.push_back({residue.chain, 0, 0, 0});
    ChainArea& chain = chains[place->second];
    ++chain.residues;
    chain.atoms += residue.atoms;
    chain.area += residue.area;
  }
  return chains;
}

std::string residue_table(std::span<const ResidueArea> residues) {
  std::string text = "chain,residue_number,residue,atoms,area\n";
  for (const auto& [chain, number, name, atoms, area] : residues)
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{:.6f}\n", field(chain), field(number),
                   field(name), atoms, area);
  return text;
}

std::string chain_table(std::span<const ChainArea> chains) {
  std::string text = "chain,residues,atoms,area\n";
  for (const auto& [chain, residues, atoms, area] : chains)
    fmt::format_to(std::back_inserter(text), "{},{},{},{:.6f}\n", field(chain), residues, atoms,
                   area);
  return text;
}

}  // namespace eses
