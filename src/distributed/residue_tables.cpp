#include "distributed/residue_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "distributed/packed_texts.hpp"
#include "distributed/shared_file.hpp"
#include "io/area_table_writer.hpp"
#include "output/short_file.hpp"

namespace eses {
namespace {

// Those of `atoms`, from the processes that have them.
std::vector<double> fetch_areas(const AtomRange& atoms, std::span<const double> areas,
                                const AtomRange& areas_of, const Processes& processes) {
  std::vector<std::vector<double>> to;
  for (const AtomRange& wanted : processes.gather<AtomRange>({&atoms, 1})) {
    const auto place = [&](std::uint64_t atom) {
      return areas.begin() + static_cast<std::ptrdiff_t>(
                                 std::clamp(atom, areas_of.begin, areas_of.end) - areas_of.begin);
    };
    to.emplace_back(place(wanted.begin), place(wanted.end));
  }
  return processes.exchange(std::move(to));
}

// A residue that may go on with the atoms of the next process.
struct OpenResidue {
  AtomLabel label;
  ResidueArea sum;  // without names

  ResidueArea closed() const {
    return {label.chain, label.residue_number, label.residue, sum.atoms, sum.area};
  }
};

// What the processes hand on, one after the other, as the sums of numbers with a point depend on
// the order: chains so far, and the last residue.
class Progress {
 public:
  Progress() = default;
  explicit Progress(const std::string& packed) : texts_(unpack(packed)) {
    auto text = texts_.begin();
    const auto next = [&]() -> std::string& { return *text++; };
    const auto next_count = [&] { return std::strtoll(next().c_str(), nullptr, 10); };
    const auto next_area = [&] { return std::strtod(next().c_str(), nullptr); };
    if (texts_.empty()) return;
    if (next() == open_mark) {
      OpenResidue& residue = open.emplace();
      residue.label = {next(), next(), next(), {}};
      residue.sum.atoms = next_count();
      residue.sum.area = next_area();
    }
    while (text != texts_.end()) {
      ChainArea chain{next()};
      chain.residues = next_count();
      chain.atoms = next_count();
      chain.area = next_area();
      chains.add(chain);
    }
  }
  // Chains are views of texts.
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  std::string packed() const {
    std::string result;
    pack(result, open ? open_mark : "");
    if (open) {
      pack(result, open->label.chain);
      pack(result, open->label.residue);
      pack(result, open->label.residue_number);
      pack(result, fmt::format("{}", open->sum.atoms));
      pack(result, fmt::format("{:a}", open->sum.area));
    }
    for (const ChainArea& chain : chains.chains()) {
      pack(result, chain.chain);
      pack(result, fmt::format("{}", chain.residues));
      pack(result, fmt::format("{}", chain.atoms));
      pack(result, fmt::format("{:a}", chain.area));
    }
    return result;
  }

  std::optional<OpenResidue> open;
  ChainAreas chains;

 private:
  static constexpr char open_mark[] = "open";
  std::vector<std::string> texts_;
};

// Adds a process's residues. Those that end there become lines of `table`; with the last process
// all have ended.
void go_on(Progress& progress, const ResidueRuns& runs, std::span<const double> areas, bool is_last,
           TextPieces& table) {
  const auto close = [&] {
    if (!progress.open) return;
    append_residue(table, progress.open->closed());
    progress.chains.add(progress.open->closed());
  };
  for (std::size_t run = 0; run < runs.labels.size(); ++run) {
    const AtomLabel& label = runs.labels[run];
    if (!progress.open || !is_same_residue(progress.open->label, label)) {
      close();
      progress.open = {label, {}};
    }
    progress.open->sum.add(areas.first(runs.atoms[run]));
    areas = areas.subspan(runs.atoms[run]);
  }
  if (is_last) close();
}

}  // namespace

std::uint64_t write_tables_jointly(const ResidueRuns& runs, const AtomRange& atoms,
                                   std::span<const double> areas, const AtomRange& areas_of,
                                   OutputFile* residues, OutputFile* chains,
                                   const Processes& processes) {
  const std::vector<double> own_areas = fetch_areas(atoms, areas, areas_of, processes);
  std::string own;
  const TextSink sink = [&own](std::string_view piece) { own += piece; };
  TextPieces table(sink);
  if (processes.is_first()) table.append(residue_table_header);
  const bool is_last = processes.rank() + 1 == processes.count();
  const std::string all = processes.hand_on(std::string(), [&](const std::string& before) {
    Progress progress(before);
    go_on(progress, runs, own_areas, is_last, table);
    return progress.packed();
  });
  table.flush();
  SharedFile shared(processes, residues);
  const std::uint64_t residue_bytes = shared.write_in_turn(own, 0);
  shared.close();
  std::uint64_t chain_bytes = 0;
  processes.agree([&] {
    if (!processes.is_first()) return;
    ShortFile file(*chains, false);
    write_chain_table(Progress(all).chains.chains(),
                      [&](std::string_view piece) { file.append(piece); });
    chain_bytes = file.size();
  });
  return residue_bytes + processes.sum(chain_bytes);
}

}  // namespace eses
