#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "distributed/packed_texts.hpp"
#include "distributed/shared_file.hpp"
#include "output/area_table_writer.hpp"
#include "output/sequential_writer.hpp"
#include "run/areas.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Returns the areas of the atoms in `wanted`. Other processes may have some of them.
std::vector<double> fetch_areas(const IndexRange& wanted, const AtomAreas& own,
                                const Processes& processes) {
  const IndexRange known = own.range();
  std::vector<std::vector<double>> to;
  for (const IndexRange& part : processes.gather<IndexRange>({&wanted, 1})) {
    const auto place = [&](std::uint64_t atom) {
      return own.areas.begin() +
             static_cast<std::ptrdiff_t>(std::clamp(atom, known.begin, known.end) - known.begin);
    };
    to.emplace_back(place(part.begin), place(part.end));
  }
  return processes.exchange(std::move(to));
}

// The message from each rank to the next one: the length of the residue table, the open residue and
// the sums of the chains so far. Areas are added in the order of the atoms, because floating-point
// sums depend on the order.
class TableState {
 public:
  explicit TableState(const std::string& packed) : texts_(unpack(packed)) {
    auto text = texts_.begin();
    const auto next = [&]() -> std::string& { return *text++; };
    const auto next_count = [&] { return std::strtoll(next().c_str(), nullptr, 10); };
    const auto next_area = [&] { return std::strtod(next().c_str(), nullptr); };
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
    pack(result, formatted("{}", bytes));
    pack(result, tables.open ? open_mark : "");
    if (tables.open) {
      const auto& [label, atoms, area] = *tables.open;
      for (const std::string* const name : {&label.chain, &label.residue, &label.residue_number})
        pack(result, *name);
      pack(result, formatted("{}", atoms));
      pack(result, formatted("{:a}", area));
    }
    for (const ChainArea& chain : tables.chains.chains()) {
      pack(result, chain.chain);
      pack(result, formatted("{}", chain.residues));
      pack(result, formatted("{}", chain.atoms));
      pack(result, formatted("{:a}", chain.area));
    }
    return result;
  }

  std::uint64_t bytes = 0;
  AreaTables tables;

 private:
  static constexpr char open_mark[] = "open";
  std::vector<std::string> texts_;
};

// Adds the residues of this process and writes the lines of complete residues.
void add_own(const RunPlan& plan, std::span<const double> areas, const Processes& processes,
             SharedFile& file, TableState& state) {
  const TextSink sink = [&](std::string_view text) {
    file.write_at(text, state.bytes);
    state.bytes += text.size();
  };
  BufferedText table(sink);
  if (processes.is_first()) append_residue_header(table);
  add_residues(state.tables, plan.residues, areas, table);
  const bool is_last = processes.rank() + 1 == processes.count();
  if (is_last) end_residues(state.tables, table);
  table.flush();
}

// The areas of the atoms that a process has read.
class AreasOfRead {
 public:
  // Keeps a reference to `areas`. All processes must call it.
  AreasOfRead(const AtomAreas& areas, const RunPlan& plan, const Processes& processes)
      : areas_(areas.areas) {  // those of all atoms in a single process
    if (processes.count() == 1) return;
    fetched_ = fetch_areas(plan.read_atoms, areas, processes);
    areas_ = fetched_;
  }
  AreasOfRead(const AreasOfRead&) = delete;
  AreasOfRead& operator=(const AreasOfRead&) = delete;

  std::span<const double> areas() const { return areas_; }

 private:
  std::vector<double> fetched_;
  std::span<const double> areas_;
};

// Returns the label of an atom, by its index among the atoms that this process has read. It is
// empty if the input has no names.
AtomLabel label_of(const RunPlan& plan, std::size_t atom) {
  if (!plan.names.is_empty()) return plan.names.label(atom);
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

}  // namespace

std::uint64_t write_area_tables(const AtomAreas& areas, const RunPlan& plan, OutputFile* residues,
                                OutputFile* chains, const Processes& processes) {
  const AreasOfRead of_read(areas, plan, processes);
  SharedFile shared(processes, residues);
  const TableState all(processes.chain(std::string(), [&](const std::string& before) {
    TableState state(before);
    add_own(plan, of_read.areas(), processes, shared, state);
    return state.packed();
  }));
  shared.close();
  std::uint64_t chain_bytes = 0;
  processes.all_or_throw([&] {
    if (!processes.is_first()) return;
    SequentialWriter file(*chains, false);
    write_chain_table(all.tables.chains.chains(),
                      [&](std::string_view piece) { file.append(piece); });
    chain_bytes = file.size();
  });
  return all.bytes + processes.sum(chain_bytes);
}

std::uint64_t write_atom_table(const AtomAreas& areas, const RunPlan& plan, OutputFile* file,
                               const std::function<void()>& check, const Processes& processes) {
  const AreasOfRead of_read(areas, plan, processes);
  SharedFile shared(processes, file);
  const std::uint64_t bytes = shared.write_by_rank(0, [&](const TextSink& sink) {
    append_atoms(plan, of_read.areas(), processes.is_first(), [&](std::string_view text) {
      check();
      sink(text);
    });
  });
  shared.close();
  return bytes;
}

}  // namespace eses::detail
