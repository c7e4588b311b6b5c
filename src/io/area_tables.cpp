#include "io/area_tables.hpp"

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

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

bool is_same_residue(const AtomLabel& a, const AtomLabel& b) {
  return a.chain == b.chain && a.residue_number == b.residue_number && a.residue == b.residue;
}

template <class Action>
void for_each_residue(std::span<const AtomLabel> labels, std::span<const double> areas,
                      Action&& action) {
  for (std::size_t i = 0; i < labels.size();) {
    const AtomLabel& first = labels[i];
    ResidueArea residue{first.chain, first.residue_number, first.residue, 0, 0};
    for (; i < labels.size() && is_same_residue(labels[i], first); ++i) {
      ++residue.atoms;
      residue.area += areas[i];
    }
    action(residue);
  }
}

std::vector<ChainArea> areas_by_chain(std::span<const AtomLabel> labels,
                                      std::span<const double> areas) {
  std::vector<ChainArea> chains;
  std::unordered_map<std::string_view, std::size_t> places;
  for_each_residue(labels, areas, [&](const ResidueArea& residue) {
    const auto [place, is_new] = places.try_emplace(residue.chain, chains.size());
    if (is_new) chains.push_back({residue.chain, 0, 0, 0});
    ChainArea& chain = chains[place->second];
    ++chain.residues;
    chain.atoms += residue.atoms;
    chain.area += residue.area;
  });
  return chains;
}

}  // namespace

void write_residue_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                         const TextSink& sink) {
  TextPieces text(sink);
  text.append("chain,residue_number,residue,atoms,area\n");
  for_each_residue(labels, areas, [&](const ResidueArea& residue) {
    text.append("{},{},{},{},{:.6f}\n", field(residue.chain), field(residue.number),
                field(residue.name), residue.atoms, residue.area);
  });
  text.flush();
}

void write_chain_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                       const TextSink& sink) {
  TextPieces text(sink);
  text.append("chain,residues,atoms,area\n");
  for (const ChainArea& chain : areas_by_chain(labels, areas))
    text.append("{},{},{},{:.6f}\n", field(chain.chain), chain.residues, chain.atoms, chain.area);
  text.flush();
}

}  // namespace eses
