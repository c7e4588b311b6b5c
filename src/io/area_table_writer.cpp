#include "io/area_table_writer.hpp"

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

template <class Action>
void for_each_residue(std::span<const AtomLabel> labels, std::span<const double> areas,
                      Action&& action) {
  for (std::size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    const AtomLabel& first = labels[begin];
    while (end < labels.size() && is_same_residue(labels[end], first)) ++end;
    ResidueArea residue{first.chain, first.residue_number, first.residue};
    residue.add(areas.subspan(begin, end - begin));
    action(residue);
  }
}

}  // namespace

void ResidueArea::add(std::span<const double> areas) {
  atoms += static_cast<std::int64_t>(areas.size());
  for (const double one : areas) area += one;
}

bool is_same_residue(const AtomLabel& a, const AtomLabel& b) {
  return a.chain == b.chain && a.residue_number == b.residue_number && a.residue == b.residue;
}

void ChainAreas::add(const ChainArea& part) {
  auto place = places_.find(part.chain);
  if (place == places_.end()) {
    place = places_.emplace(part.chain, chains_.size()).first;
    chains_.push_back({place->first, 0, 0, 0});
  }
  ChainArea& chain = chains_[place->second];
  chain.residues += part.residues;
  chain.atoms += part.atoms;
  chain.area += part.area;
}

void append_residue(TextPieces& text, const ResidueArea& residue) {
  text.append("{},{},{},{},{:.6f}\n", field(residue.chain), field(residue.number),
              field(residue.name), residue.atoms, residue.area);
}

void write_residue_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                         const TextSink& sink) {
  TextPieces text(sink);
  text.append(residue_table_header);
  for_each_residue(labels, areas,
                   [&](const ResidueArea& residue) { append_residue(text, residue); });
  text.flush();
}

void write_chain_table(std::span<const AtomLabel> labels, std::span<const double> areas,
                       const TextSink& sink) {
  ChainAreas chains;
  for_each_residue(labels, areas, [&](const ResidueArea& residue) { chains.add(residue); });
  write_chain_table(chains.chains(), sink);
}

void write_chain_table(std::span<const ChainArea> chains, const TextSink& sink) {
  TextPieces text(sink);
  text.append("chain,residues,atoms,area\n");
  for (const ChainArea& chain : chains)
    text.append("{},{},{},{:.6f}\n", field(chain.chain), chain.residues, chain.atoms, chain.area);
  text.flush();
}

}  // namespace eses
