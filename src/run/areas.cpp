#include "run/areas.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "distributed/packed_texts.hpp"
#include "distributed/shared_file.hpp"
#include "input/text_fields.hpp"
#include "output/area_table_writer.hpp"
#include "output/eses_writer.hpp"
#include "solve/region_totals.hpp"
#include "system/formatted.hpp"
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
  if (processes.count() == 1) to.front().reserve(plan.atoms);
  auto send = [&, rank = 0](const AtomSum& sum) mutable {
    while (as_number(sum.atom) < atoms_of(rank, plan, processes).begin) --rank;
    while (as_number(sum.atom) >= atoms_of(rank, plan, processes).end) ++rank;
    to[static_cast<std::size_t>(rank)].push_back(sum);
  };
  plan.slab.for_each_sum(shares.of_slab, send);
  for (const AtomSum& sum : shares.restored) send(sum);
  shares = {};
  const auto [begin, end] = atoms_of(processes.rank(), plan, processes);
  std::vector<AreaShare> sums(end - begin);
  for (const AtomSum& sum : processes.exchange(std::move(to)))
    sums[as_number(sum.atom) - begin] += sum.share;
  return sums;
}

// Passes this process's lines of partition_area.txt to `sink`, compressed if necessary.
void append_area_texts(const AreasOfRange& atoms, bool is_gzipped,
                       const std::function<void()>& check, const TextSink& sink) {
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

// Returns the areas of the atoms that this process has read. Other processes may have some of them.
// All processes must call it.
std::vector<double> areas_of_read_atoms(const AreasOfRange& known, const RunPlan& plan,
                                        const Processes& processes) {
  const IndexRange range = known.range();
  std::vector<std::vector<double>> to;
  for (const IndexRange& part : processes.gather<IndexRange>({&plan.read_atoms, 1})) {
    const auto area_of = [&](std::uint64_t file_index) {
      return known.areas.begin() +
             static_cast<std::ptrdiff_t>(std::clamp(file_index, range.begin, range.end) -
                                         range.begin);
    };
    to.emplace_back(area_of(part.begin), area_of(part.end));
  }
  return processes.exchange(std::move(to));
}

// Returns the area in a text that a rank has sent. The result does not depend on the locale.
double area_in(std::string_view text) {
  double area = 0;
  parse_number(text, area);
  return area;
}

// The message from each rank to the next one: the length of the residue table, the open residue and
// the sums of the chains so far. Areas are added in the order of the atoms, because floating-point
// sums depend on the order.
class TableState {
 public:
  explicit TableState(const std::string& packed) : texts_(unpack(packed)) {
    auto text = texts_.begin();
    const auto next = [&]() -> std::string& { return *text++; };
    const auto next_count = [&] {
      std::int64_t count = 0;
      parse_integer(next(), count);
      return count;
    };
    const auto next_area = [&] { return area_in(next()); };
    if (texts_.empty()) return;
    bytes = static_cast<std::uint64_t>(next_count());
    if (next() == open_mark) {
      ResidueArea& residue = tables.open.emplace();
      residue.label = {next(), next(), next(), {}, {}};
      residue.atoms = next_count();
      residue.area = next_area();
    }
    while (text != texts_.end()) {
      ChainArea chain{next()};
      chain.residues = next_count();
      chain.atoms = next_count();
      chain.area = next_area();
      tables.chains.add(chain);
    }
  }

  std::string packed() const {
    std::string result;
    // The text of a number that `{}` writes has exactly its value.
    const auto put = [&result](const auto&... values) {
      (pack(result, formatted("{}", values)), ...);
    };
    put(bytes, tables.open ? open_mark : "");
    if (tables.open) {
      const auto& [label, atoms, area] = *tables.open;
      put(label.chain, label.residue, label.residue_number, atoms, area);
    }
    for (const auto& [chain, residues, atoms, area] : tables.chains.chains())
      put(chain, residues, atoms, area);
    return result;
  }

  std::uint64_t bytes = 0;
  AreaTables tables;

 private:
  static constexpr char open_mark[] = "open";
  std::vector<std::string> texts_;
};

// Adds the residues that this process has read, and writes the lines of complete residues.
void append_residues_read(const RunPlan& plan, std::span<const double> areas,
                          const Processes& processes, SharedFile& file, TableState& state) {
  BufferedText table([&](std::string_view text) {
    file.write_at(text, state.bytes);
    state.bytes += text.size();
  });
  if (processes.is_first()) append_residue_header(table);
  add_residues(state.tables, plan.names.residues(), areas, table);
  const bool is_last = processes.rank() + 1 == processes.count();
  if (is_last) end_residues(state.tables, table);
  table.flush();
}

// Returns the label of an atom, by its index among the atoms that this process has read. It is
// empty if the input has no names.
AtomLabel label_of(const RunPlan& plan, std::size_t atom) {
  if (plan.names.has_atoms()) return plan.names.label(atom);
  const std::span<const AtomLabel> labels = plan.slab.molecule.labels();
  return labels.empty() ? AtomLabel() : labels[atom];
}

// Passes the lines of atoms.csv for the atoms that this process has read to `sink`.
void append_atoms(const RunPlan& plan, std::span<const double> areas, bool with_header,
                  const TextSink& sink) {
  BufferedText table(sink);
  if (with_header) append_atom_header(table);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double radius = plan.radii.empty() ? plan.slab.molecule.atoms()[i].radius : plan.radii[i];
    append_atom(table, {plan.read_atoms.begin + i + 1, label_of(plan, i), radius, areas[i]});
  }
  table.flush();
}

// Writes a file whose parts follow each other in the order of ranks. See
// SharedFile::write_by_rank.
std::uint64_t write_text(OutputFile* file, const Processes& processes,
                         const std::function<void(const TextSink& sink)>& make) {
  SharedFile shared(processes, file);
  const std::uint64_t bytes = shared.write_by_rank(0, make);
  shared.close();
  return bytes;
}

}  // namespace

AreasOfRange add_up_areas(AtomShares shares, const RunPlan& plan, const Processes& processes) {
  const std::vector<AreaShare> sums = exchange_shares(std::move(shares), plan, processes);
  AreasOfRange areas{atoms_of(processes.rank(), plan, processes).begin, {}};
  areas.areas.reserve(sums.size());
  for (const AreaShare sum : sums) areas.areas.push_back(atom_area(sum, plan.grid.spacing));
  return areas;
}

double total_area(const AreasOfRange& areas, const Processes& processes) {
  return area_in(processes.chain("0", [&](const std::string& before) {
    double sum = area_in(before);
    for (const double area : areas.areas) sum += area;
    return formatted("{}", sum);  // has exactly the value of the sum
  }));
}

std::uint64_t write_areas(const AreasOfRange& areas, bool gzip, OutputFile* file,
                          const std::function<void()>& check, const Processes& processes) {
  return write_text(file, processes,
                    [&](const TextSink& sink) { append_area_texts(areas, gzip, check, sink); });
}

std::uint64_t write_area_tables(const AreasOfRange& areas, const RunPlan& plan,
                                OutputFile* residues, OutputFile* chains,
                                const Processes& processes) {
  const std::vector<double> read_areas = areas_of_read_atoms(areas, plan, processes);
  SharedFile shared(processes, residues);
  const TableState all(processes.chain(std::string(), [&](const std::string& before) {
    TableState state(before);
    append_residues_read(plan, read_areas, processes, shared, state);
    return state.packed();
  }));
  shared.close();
  std::uint64_t chain_bytes = 0;
  processes.all_or_throw([&] {
    if (!processes.is_first()) return;
    BufferedText table([&](std::string_view text) { chains->append(text); });
    append_chains(table, all.tables.chains.chains());
    table.flush();
    chain_bytes = chains->size();
  });
  return all.bytes + processes.sum(chain_bytes);
}

std::uint64_t write_atom_table(const AreasOfRange& areas, const RunPlan& plan, OutputFile* file,
                               const std::function<void()>& check, const Processes& processes) {
  const std::vector<double> read_areas = areas_of_read_atoms(areas, plan, processes);
  return write_text(file, processes, [&](const TextSink& sink) {
    append_atoms(plan, read_areas, processes.is_first(), [&](std::string_view text) {
      check();
      sink(text);
    });
  });
}

}  // namespace eses::detail
