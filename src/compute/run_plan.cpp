#include "compute/run_plan.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <utility>

#include "eses/error.hpp"
#include "eses/version.hpp"
#include "io/atom_lines.hpp"
#include "io/atom_names.hpp"
#include "mesh/mesh_writer.hpp"
#include "output/grid_map.hpp"
#include "plan/atom_hash.hpp"
#include "plan/plan.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 4;

// Returns a hash of all atoms. It does not depend on the division of the atoms among the processes.
std::uint64_t hash_of(const AtomShare& share, const Processes& processes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < share.atoms.size(); ++i) {
    std::uint64_t hash = atom_hash(share.atoms[i], share.first + i);
    if (!share.groups.empty())
      hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(share.groups[i]));
    sum += hash;
  }
  return processes.sum(sum);
}

// Returns a hash of all names. It does not depend on the division of the names among the processes.
std::uint64_t hash_of(const GroupNames& groups, const Processes& processes) {
  std::uint64_t sum = 0, number = groups.first_residue;
  for (const AtomLabel& label : groups.residues) {
    uLong hash = 0;
    for (const std::string* const text : {&label.chain, &label.residue, &label.residue_number})
      hash = crc32_z(hash, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    sum += splitmix64(hash ^ number++ << 32);
  }
  return processes.sum(sum);
}

std::string mesh_identity(const std::optional<MeshOptions>& mesh) {
  if (!mesh) return "none";
  return formatted("{} {}", static_cast<int>(required_mesh_format(*mesh)),
                   static_cast<int>(mesh->color));
}

// Identifies the maps. The permittivities are left out, because chunks contain inside lengths of
// edges, which do not depend on them.
std::string map_identity(const Outputs& outputs) {
  std::string identity;
  for (const MapChoice& map : chosen_maps(outputs))
    identity += formatted("{} ", static_cast<int>(map.quantity));
  if (outputs.ion_access) identity += formatted("{:a}", outputs.ion_access->ion_radius);
  return identity;
}

// Returns a text that differs between runs whose chunks must not be combined.
std::string identity_of(const RunTask& task, const RunPlan& run, std::uint64_t hash) {
  const Parameters& p = task.parameters;
  const Grid& grid = run.whole.grid;
  const GridRegion& region = run.whole.tiling.region;
  return formatted(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "origin {:a} {:a} {:a} size {}\npoints {} {}\ngrid {} edges {} gzip {} maps {} mesh {}\n",
      version, checkpoint_format, sizeof(ChunkInfo), task.outputs.gzip ? zlibVersion() : "",
      run.atoms, hash, p.probe_radius, p.spacing, p.margin, grid.origin.x, grid.origin.y,
      grid.origin.z, fmt::join(grid.size, " "), fmt::join(region.begin, " "),
      fmt::join(region.end, " "), task.outputs.grid, task.outputs.edges, task.outputs.gzip,
      map_identity(task.outputs), mesh_identity(task.outputs.mesh));
}

bool names_groups(const Outputs& outputs) {
  return outputs.mesh && mesh::can_name_groups(*outputs.mesh);
}

// Throws Error if no schedule keeps the memory limit for this number of atoms. It is called before
// anything is computed from the atoms. For few atoms, plan_schedule reports the minimum limit
// instead.
void require_memory_for(std::uint64_t atoms, const RunTask& task, const Processes& processes) {
  const auto count = static_cast<std::uint64_t>(processes.count());
  const double needed = min_expected_memory((atoms + count - 1) / count);
  const std::uint64_t limit = task.parameters.max_memory;
  if (limit == 0 || needed <= static_cast<double>(limit) || needed < 2 * min_expected_memory(0))
    return;
  throw LimitExceeded(formatted(
      "{}: {} atoms need more than {} of memory{}, but the limit is {}; use a larger limit",
      task.input.string(), atoms, binary_bytes_text(static_cast<std::uint64_t>(needed)),
      count > 1 ? " in each process" : "", binary_bytes_text(limit)));
}

// Throws Error if reading and indexing the atoms has exceeded the memory limit.
void require_memory_held(const RunTask& task) {
  const std::uint64_t limit = task.parameters.max_memory, peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw LimitExceeded(
      formatted("{}: reading the atoms took {} of memory, but the limit is {}; use a larger limit",
                task.input.string(), binary_bytes_text(peak), binary_bytes_text(limit)));
}

// Converts the labels of a part of the molecule into the data that the outputs need: numbers and
// names of groups, and residues for tables. Returns the totals of the labels.
LabelTotals take_labels(ResidueRuns residues, const Outputs& outputs, const Processes& processes,
                        RunPlan& run, std::vector<mesh::GroupNumbers>& groups) {
  if (names_groups(outputs)) {
    GroupNumbering numbered = number_groups(residues, processes);
    run.groups = std::move(numbered.names);
    groups = std::move(numbered.of_atom);
  }
  const LabelTotals totals = total_labels(residues.labels);
  if (outputs.residues) run.residues = std::move(residues);
  return totals;
}

// Returns the totals of the labels that stay in the memory of this process.
LabelTotals labels_held(LabelTotals totals, const RunPlan& run, const Outputs& outputs) {
  if (!outputs.residues) {
    totals.labels = 0;
    totals.heap_bytes = 0;
  }
  for (const auto* const names : {&run.groups.chains, &run.groups.residues}) {
    totals.labels += names->size();
    totals.heap_bytes += total_labels(*names).heap_bytes;
  }
  // Atoms have group numbers even in a process without the first atom of any group.
  if (run.groups.are_known) ++totals.labels;
  return totals;
}

// Returns the sums over all processes, without the labels and bytes in memory.
LabelTotals sum_labels(const LabelTotals& own, const Processes& processes) {
  std::array<std::uint64_t, 4> sums{own.residue_runs, own.chain_runs, own.residue_text_bytes,
                                    own.chain_text_bytes};
  processes.add(sums);
  LabelTotals all;
  all.residue_runs = sums[0];
  all.chain_runs = sums[1];
  all.residue_text_bytes = sums[2];
  all.chain_text_bytes = sums[3];
  return all;
}

Box bounds_of_all(std::span<const Atom> atoms, const Processes& processes) {
  const Box own = sphere_bounds(atoms);
  std::array<double, 3> low{own.low.x, own.low.y, own.low.z};
  std::array<double, 3> high{own.high.x, own.high.y, own.high.z};
  processes.allreduce_min(low);
  processes.allreduce_max(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

// Opens the checkpoint of a run that can be resumed, and finds its complete chunks.
void open_checkpoint(const RunTask& task, const AtomShare& share, const Processes& processes,
                     RunPlan& run) {
  if (!task.resume) return;
  const std::uint64_t hash = hash_of(share, processes) ^ hash_of(run.groups, processes);
  std::vector<PlaneRange> done;
  processes.all_or_throw([&] {
    run.checkpoint =
        std::make_unique<Checkpoint>(task.output_directory, identity_of(task, run, hash));
    if (!processes.is_first()) return;
    if (!task.dry_run) run.checkpoint->lock();
    done = run.checkpoint->complete();
    if (!task.dry_run) run.checkpoint->remove_others(done);
  });
  run.done = processes.gather<PlaneRange>(done);
}

// Adds the labels of the examples to the diagnostics if the names of the atoms are known.
void name_examples(const AtomNames& names, FileDiagnostics& diagnostics) {
  if (names.is_empty()) return;
  for (const auto& [atom, line] : diagnostics.lines) diagnostics.labels[atom] = names.label(atom);
}

// Returns the number of threads of this process. Several processes on a machine share its
// processors.
int threads_of(const RunTask& task, const Processes::Machine& machine, const Processes& processes) {
  const int chosen = task.parameters.threads;
  return chosen > 0 || processes.count() == 1 ? chosen : machine.processors;
}

// Makes the plan of this process's slab. Returns the expected number of crossings in the slab.
double plan_slab(const RunTask& task, const LabelTotals& labels, const Processes::Machine& machine,
                 const Processes& processes, RunPlan& run) {
  run.own = run.whole;
  run.own.tiling.region = with_planes(run.whole.tiling.region, run.slab.planes);
  run.own.parameters.threads = threads_of(task, machine, processes);
  double crossings = 0;
  processes.all_or_throw([&] {
    if (run.slab.planes.is_empty()) return;
    const auto sharing = static_cast<std::uint64_t>(machine.processes);
    crossings = plan_schedule({.available = available_memory() / sharing,
                               .held = processes.own_memory(),
                               .labels = labels},
                              run.slab.molecule, task.outputs, run.own);
    require_memory_held(task);
  });
  return crossings;
}

// Sets the schedule of the whole run to the maxima over all processes.
void combine_schedules(const Processes& processes, RunPlan& run) {
  const GridIndex& block_size = run.own.tiling.block_size;
  std::array<std::uint64_t, 6> maxima{run.own.memory_bytes,
                                      static_cast<std::uint64_t>(run.own.blocks_ahead),
                                      static_cast<std::uint64_t>(run.own.threads),
                                      static_cast<std::uint64_t>(block_size[0]),
                                      static_cast<std::uint64_t>(block_size[1]),
                                      static_cast<std::uint64_t>(block_size[2])};
  processes.allreduce_max(maxima);
  Plan& whole = run.whole;
  const GridRegion region = whole.tiling.region;
  whole.memory_bytes = maxima[0];
  whole.blocks_ahead = static_cast<std::int64_t>(maxima[1]);
  whole.threads = static_cast<int>(maxima[2]);
  const auto side = [&](std::size_t axis) { return static_cast<std::int64_t>(maxima[3 + axis]); };
  whole.tiling = make_tiling(whole.grid, GridIndex{side(0), side(1), side(2)}, region);
}

// Adds the sizes of the chunks, which are on disk until they are merged. A checkpoint has all
// texts; otherwise the texts of the mesh are in the mesh's directory.
void expect_chunks(const RunTask& task, Plan& whole) {
  whole.text_scratch_bytes = whole.grid_file_bytes + whole.edge_file_bytes;
  for (const MapChoice& map : chosen_maps(task.outputs))
    whole.text_scratch_bytes += GridMap::row_bytes(map.quantity, whole.tiling.region);
  whole.mesh_scratch_bytes = task.resume ? 0 : whole.mesh_file_bytes;
  if (task.resume) whole.text_scratch_bytes += whole.mesh_file_bytes;
}

}  // namespace

RunPlan plan_run(const RunTask& task, const Processes& processes) {
  const Outputs& outputs = task.outputs;
  RunPlan run;
  const bool has_names = is_structure(format_of(task.input, task.format));
  AtomShare share =
      read_share(task.input,
                 {.format = task.format,
                  .with_labels = has_names || outputs.residues || names_groups(outputs),
                  .max_memory = task.parameters.max_memory,
                  .structure = task.structure},
                 processes);
  run.structure = std::move(share.structure);
  AtomNames names = std::exchange(share.names, {});
  processes.all_or_throw([&] { require_memory_for(share.total, task, processes); });
  run.atoms = share.total;
  run.read = share.range();
  const LabelTotals labels =
      take_labels(std::exchange(share.residues, {}), outputs, processes, run, share.groups);
  const Box bounds = bounds_of_all(share.atoms, processes);
  processes.all_or_throw([&] { run.whole = plan_grid(bounds, task.parameters); });
  open_checkpoint(task, share, processes, run);

  const Processes::Machine machine = processes.machine(available_threads());
  SlabOfMolecule part = make_slab(std::move(share), run.whole, outputs, run.done,
                                  threads_of(task, machine, processes), processes);
  run.slab = std::move(part.slab);
  run.diagnostics = std::move(part.diagnostics);
  name_examples(std::exchange(names, {}), run.diagnostics);
  release_free_memory();

  std::array crossings{plan_slab(task, labels_held(labels, run, outputs), machine, processes, run)};
  processes.add(std::span<double>(crossings));
  combine_schedules(processes, run);
  plan_files({run.atoms, crossings[0], sum_labels(labels, processes)}, outputs, run.whole);
  if (!writes_in_place(task, processes)) expect_chunks(task, run.whole);
  return run;
}

RunPlan plan_of_molecule(const Molecule& molecule, const Plan& plan, const Outputs& outputs) {
  RunPlan run;
  run.whole = run.own = plan;
  run.atoms = molecule.atoms().size();
  run.read = {0, run.atoms};
  run.slab.planes = region_planes(plan);
  run.slab.molecule = molecule;
  if (outputs.residues || names_groups(outputs))
    take_labels(residue_runs(molecule.labels()), outputs, Processes(), run, run.slab.groups);
  return run;
}

bool writes_in_place(const RunTask& task, const Processes& processes) {
  return processes.count() == 1 && !task.resume;
}

}  // namespace eses::detail
