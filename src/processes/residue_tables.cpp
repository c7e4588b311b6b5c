#include "processes/residue_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "io/area_tables.hpp"
#include "processes/shared_file.hpp"
#include "processes/text_list.hpp"
#include "run/short_file.hpp"

namespace eses {
namespace {

struct AtomRange {
  std::uint64_t begin = 0, end = 0;
};

// Of the share's atoms, from those who have them.
std::vector<double> fetch_areas(const ResidueShare& share, std::span<const double> areas,
                                std::uint64_t first, const Processes& processes) {
  const AtomRange wanted{share.first, share.end};
  std::vector<std::vector<double>> to;
  for (const AtomRange& range : processes.gather<AtomRange>({&wanted, 1})) {
    const auto place = [&](std::uint64_t atom) {
      return areas.begin() +
             static_cast<std::ptrdiff_t>(std::clamp(atom, first, first + areas.size()) - first);
    };
    to.emplace_back(place(range.begin), place(range.end));
  }
  return processes.exchange(std::move(to));
}

// What a process's atoms begin and end with.
struct Ends {
  std::size_t residues = 0;
  AtomLabel first, last;
};

std::vector<Ends> gather_ends(const ResidueShare& share, const Processes& processes) {
  std::string own;
  append_text(own, fmt::format("{}", share.residues.size()));
  const AtomLabel none;
  for (const AtomLabel& label : {share.residues.empty() ? none : share.residues.front(),
                                 share.residues.empty() ? none : share.residues.back()})
    for (const std::string* text : {&label.chain, &label.residue, &label.residue_number})
      append_text(own, *text);
  const std::vector<char> all = processes.gather<char>(own);
  const std::vector<std::string> texts = split_texts({all.begin(), all.end()});
  std::vector<Ends> ends;
  for (auto text = texts.begin(); text != texts.end(); text += 7)
    ends.push_back(
        {std::stoul(text[0]), {text[1], text[2], text[3], {}}, {text[4], text[5], text[6], {}}});
  return ends;
}

// The process that has the beginning of the residue with which a process's atoms begin.
int owner_of_first(std::span<const Ends> ends, int rank) {
  int owner = rank;
  for (int before = rank - 1; before >= 0; --before) {
    const Ends& end = ends[static_cast<std::size_t>(before)];
    if (end.residues == 0) continue;
    if (!is_same_residue(end.last, ends[static_cast<std::size_t>(owner)].first)) break;
    owner = before;
    if (end.residues > 1) break;
  }
  return owner;
}

// Those that begin in the share, with all of their atoms.
std::vector<ResidueArea> own_residues(const ResidueShare& share, std::span<const double> areas,
                                      const Processes& processes) {
  const int rank = processes.rank(), owner = owner_of_first(gather_ends(share, processes), rank);
  const bool gives = owner != rank && !share.residues.empty();
  std::vector<std::vector<double>> to(static_cast<std::size_t>(processes.count()));
  if (gives) {
    const auto given = areas.first(share.residue_atoms.front());
    to[static_cast<std::size_t>(owner)].assign(given.begin(), given.end());
    areas = areas.subspan(given.size());
  }
  const std::vector<double> further = processes.exchange(std::move(to));
  std::vector<ResidueArea> residues;
  for (std::size_t i = gives ? 1 : 0; i < share.residues.size(); ++i) {
    const AtomLabel& label = share.residues[i];
    ResidueArea& residue =
        residues.emplace_back(ResidueArea{label.chain, label.residue_number, label.residue});
    residue.add(areas.first(share.residue_atoms[i]));
    areas = areas.subspan(share.residue_atoms[i]);
  }
  if (!further.empty()) residues.back().add(further);
  return residues;
}

std::uint64_t write_residues(std::span<const ResidueArea> residues, OutputFile* file,
                             const Processes& processes) {
  std::string own;
  const TextSink sink = [&own](std::string_view piece) { own += piece; };
  TextPieces text(sink);
  if (processes.is_first()) text.append(residue_table_header);
  for (const ResidueArea& residue : residues) append_residue(text, residue);
  text.flush();
  SharedFile shared(processes, file);
  shared.write_at(own, processes.sum_before(own.size()));
  shared.close();
  return processes.sum(own.size());
}

std::string chains_text(std::span<const ChainArea> chains) {
  std::string list;
  for (const ChainArea& chain : chains) {
    append_text(list, chain.chain);
    for (const std::int64_t count : {chain.residues, chain.atoms})
      append_text(list, fmt::format("{}", count));
    append_text(list, fmt::format("{:a}", chain.area));
  }
  return list;
}

// Those of `texts`, which must outlive them.
ChainAreas chains_of(std::span<const std::string> texts) {
  ChainAreas chains;
  for (; !texts.empty(); texts = texts.subspan(4))
    chains.add(ChainArea{texts[0], std::stoll(texts[1]), std::stoll(texts[2]),
                         std::strtod(texts[3].c_str(), nullptr)});
  return chains;
}

std::uint64_t write_chains(std::span<const ResidueArea> residues, OutputFile* file,
                           const Processes& processes) {
  // One after the other, as the sums of numbers with a point depend on the order.
  const std::string all = processes.hand_on(std::string(), [&](const std::string& before) {
    const std::vector<std::string> texts = split_texts(before);
    ChainAreas chains = chains_of(texts);
    for (const ResidueArea& residue : residues) chains.add(residue);
    return chains_text(chains.chains());
  });
  std::uint64_t bytes = 0;
  processes.agree([&] {
    if (!processes.is_first()) return;
    ShortFile table(*file, false);
    const std::vector<std::string> texts = split_texts(all);
    write_chain_table(chains_of(texts).chains(),
                      [&](std::string_view piece) { table.append(piece); });
    bytes = table.size();
  });
  return processes.sum(bytes);
}

}  // namespace

std::uint64_t write_tables_jointly(const ResidueShare& share, std::span<const double> areas,
                                   std::uint64_t first, OutputFile* residues, OutputFile* chains,
                                   const Processes& processes) {
  const std::vector<double> own_areas = fetch_areas(share, areas, first, processes);
  const std::vector<ResidueArea> own = own_residues(share, own_areas, processes);
  return write_residues(own, residues, processes) + write_chains(own, chains, processes);
}

}  // namespace eses
