#include "run/areas.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "distributed/shared_file.hpp"
#include "output/eses_writer.hpp"
#include "solve/region_totals.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

// Number of lines of partition_area.txt that are formatted and compressed at a time.
constexpr std::size_t lines_per_part = std::size_t{1} << 16;

// Returns the atoms whose areas a rank has. Ranges begin at multiples of `lines_per_part`, so that
// the parts of the file do not depend on the number of ranks.
IndexRange atoms_of(int rank, const RunPlan& plan, const Processes& processes) {
  return processes.range_of(plan.atoms, lines_per_part, rank);
}

// Sends the shares of each atom to the process that has its area, and adds them up.
std::vector<AreaShare> exchange_shares(AtomShares shares, const RunPlan& plan,
                                       const Processes& processes) {
  std::vector<std::vector<AtomSum>> to(static_cast<std::size_t>(processes.count()));
  auto send = [&, rank = 0](const AtomSum& sum) mutable {
    while (sum.atom < atoms_of(rank, plan, processes).begin) --rank;
    while (sum.atom >= atoms_of(rank, plan, processes).end) ++rank;
    to[static_cast<std::size_t>(rank)].push_back(sum);
  };
  for (std::size_t i = 0; i < shares.of_slab.size(); ++i)
    if (shares.of_slab[i] != 0)
      send({shares.of_slab[i], plan.slab.file_index_of(static_cast<AtomIndex>(i))});
  for (const AtomSum& sum : shares.restored) send(sum);
  shares = {};
  const auto [begin, end] = atoms_of(processes.rank(), plan, processes);
  std::vector<AreaShare> sums(end - begin);
  for (const AtomSum& sum : processes.exchange(std::move(to))) sums[sum.atom - begin] += sum.share;
  return sums;
}

// Returns the shares of all atoms in a single process.
std::vector<AreaShare> shares_alone(AtomShares shares, const RunPlan& plan) {
  std::vector<AreaShare> sums = std::move(shares.of_slab);
  sums.resize(plan.atoms);
  for (const AtomSum& sum : shares.restored) sums[sum.atom] += sum.share;
  return sums;
}

// Passes this process's lines of partition_area.txt to `sink`, compressed if necessary.
void append_area_texts(const AtomAreas& atoms, bool is_gzipped, const std::function<void()>& check,
                       const TextSink& sink) {
  std::optional<Gzip> gzip;
  if (is_gzipped) gzip.emplace();
  const std::span<const double> areas = atoms.areas;
  TextBuffer text;
  for (std::size_t begin = 0; begin < areas.size(); begin += lines_per_part) {
    check();
    text.clear();
    append_areas(text, atoms.first + begin,
                 areas.subspan(begin, std::min(lines_per_part, areas.size() - begin)));
    const std::span<const char> bytes = gzip ? gzip->member(text.text()) : text.text();
    sink({bytes.data(), bytes.size()});
  }
}

}  // namespace

AtomAreas add_up_areas(AtomShares shares, const RunPlan& plan, const Processes& processes) {
  const std::vector<AreaShare> sums = processes.count() == 1
                                          ? shares_alone(std::move(shares), plan)
                                          : exchange_shares(std::move(shares), plan, processes);
  AtomAreas areas{atoms_of(processes.rank(), plan, processes).begin, {}};
  areas.areas.reserve(sums.size());
  for (const AreaShare sum : sums)
    areas.areas.push_back(atom_area(sum, plan.whole_plan.grid.spacing));
  return areas;
}

double total_area(const AtomAreas& areas, const Processes& processes) {
  return processes.chain(0, [&](double sum) {
    for (const double area : areas.areas) sum += area;
    return sum;
  });
}

std::uint64_t write_areas(const AtomAreas& areas, bool gzip, OutputFile* file,
                          const std::function<void()>& check, const Processes& processes) {
  SharedFile shared(processes, file);
  const std::uint64_t bytes = shared.write_by_rank(
      0, [&](const TextSink& sink) { append_area_texts(areas, gzip, check, sink); });
  shared.close();
  return bytes;
}

}  // namespace eses::detail
