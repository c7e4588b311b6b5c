#include "run/run_plan.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "eses/version.hpp"
#include "grid/make_grid.hpp"
#include "input/atom_names.hpp"
#include "input/other_formats.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_writer.hpp"
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

// Returns a hash of an atom and its index in the molecule.
std::uint64_t hash_of(const Atom& atom, std::uint64_t index) {
  const auto& [center, radius] = atom;
  std::uint64_t hash = splitmix64(index);
  for (const double value : {center.x, center.y, center.z, radius})
    hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
  return hash;
}

// Returns a hash of all atoms. It does not depend on the division of the atoms among the processes.
std::uint64_t hash_of(const AtomShare& share, const Processes& processes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < share.atoms.size(); ++i) {
    std::uint64_t hash = hash_of(share.atoms[i], share.first + i);
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
void require_memory_for(std::uint64_t atoms, const InputFile& file, std::uint64_t limit,
                        const Processes& processes) {
  const auto count = static_cast<std::uint64_t>(processes.count());
  const double needed = min_expected_memory((atoms + count - 1) / count);
  if (limit == 0 || needed <= static_cast<double>(limit) || needed < 2 * min_expected_memory(0))
    return;
  throw LimitExceeded(formatted(
      "{}: {} atoms need more than {} of memory{}, but the limit is {}; use a larger limit",
      file.path.string(), atoms, binary_bytes_text(static_cast<std::uint64_t>(needed)),
      count > 1 ? " in each process" : "", binary_bytes_text(limit)));
}

// Throws Error if reading and indexing the atoms has exceeded the memory limit.
void require_memory_held(const InputFile& file, std::uint64_t limit) {
  const std::uint64_t peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw LimitExceeded(
      formatted("{}: reading the atoms took {} of memory, but the limit is {}; use a larger limit",
                file.path.string(), binary_bytes_text(peak), binary_bytes_text(limit)));
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
  LabelTotals totals = total_labels(residues.labels);
  totals.atom_text_bytes = run.names.text_bytes();
  if (outputs.residues) run.residues = std::move(residues);
  return totals;
}

// Returns these totals with the number and the heap memory of the labels that stay in the memory of
// this process.
LabelTotals with_labels_held(LabelTotals totals, const RunPlan& run) {
  totals.labels = run.groups.are_known ? 1 : 0;  // for the group numbers of atoms
  totals.heap_bytes = 0;
  for (const std::span<const AtomLabel> labels :
       {std::span<const AtomLabel>(run.residues.labels),
        std::span<const AtomLabel>(run.groups.chains),
        std::span<const AtomLabel>(run.groups.residues),
        std::span<const AtomLabel>(run.names.residues()), run.slab.molecule.labels()}) {
    totals.labels += labels.size();
    totals.heap_bytes += total_labels(labels).heap_bytes;
  }
  return totals;
}

// Returns the sums over all processes, without the labels and bytes in memory.
LabelTotals sum_labels(const LabelTotals& own, const Processes& processes) {
  std::array<std::uint64_t, 5> sums{own.residue_runs, own.chain_runs, own.residue_text_bytes,
                                    own.chain_text_bytes, own.atom_text_bytes};
  processes.add(sums);
  LabelTotals all;
  all.residue_runs = sums[0];
  all.chain_runs = sums[1];
  all.residue_text_bytes = sums[2];
  all.chain_text_bytes = sums[3];
  all.atom_text_bytes = sums[4];
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

std::vector<double> radii_of(std::span<const Atom> atoms) {
  std::vector<double> radii;
  radii.reserve(atoms.size());
  for (const Atom& atom : atoms) radii.push_back(atom.radius);
  return radii;
}

// Adds the labels of the examples to the diagnostics if this process knows the names of the atoms.
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

// Makes the plan of this process's slab. `labels` are those in its memory.
void plan_slab(const RunTask& task, const LabelTotals& labels, const Processes::Machine& machine,
               const Processes& processes, RunPlan& run) {
  run.own = run.whole;
  run.own.tiling.region = with_planes(run.whole.tiling.region, run.slab.planes);
  run.own.parameters.threads = threads_of(task, machine, processes);
  processes.all_or_throw([&] {
    if (run.slab.planes.is_empty()) return;
    const auto sharing = static_cast<std::uint64_t>(machine.processes);
    plan_schedule(
        {.available = available_memory() / sharing,
         .held = processes.own_memory() + run.names.bytes() + run.radii.size() * sizeof(double),
         .labels = labels,
         .caller = task.caller_memory},
        run.slab.molecule, task.outputs, run.own);
    if (const auto* file = std::get_if<InputFile>(&task.atoms))
      require_memory_held(*file, task.parameters.max_memory);
  });
}

// Sets the schedule of the whole run to the maxima over all processes, and its crossings to the
// sum.
void combine_schedules(const Processes& processes, RunPlan& run) {
  std::array crossings{run.own.crossings};
  processes.add(std::span<double>(crossings));
  run.whole.crossings = crossings[0];
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
  whole.files.text_scratch = whole.files.grid + whole.files.edges;
  for (const MapChoice& map : chosen_maps(task.outputs))
    whole.files.text_scratch += GridMap::row_bytes(map.quantity, whole.tiling.region);
  whole.files.mesh_scratch = task.resume ? 0 : whole.files.mesh;
  if (task.resume) whole.files.text_scratch += whole.files.mesh;
}

// Reads the file, makes the grid, and gives this process its slab. Returns the labels of the atoms
// that this process has read.
LabelTotals take_file(const InputFile& file, const RunTask& task, const Processes::Machine& machine,
                      const Processes& processes, RunPlan& run) {
  const Outputs& outputs = task.outputs;
  const std::uint64_t limit = task.parameters.max_memory;
  const bool has_names = is_structure(format_of(file.path, file.format));
  AtomShare share = read_share(
      file.path,
      {.format = file.format,
       .with_labels = has_names || outputs.residues || outputs.atoms || names_groups(outputs),
       .max_memory = limit,
       .structure = file.structure},
      outputs.atoms, processes);
  run.structure = std::move(share.structure);
  run.names = std::exchange(share.names, {});
  if (outputs.atoms && processes.count() > 1) run.radii = radii_of(share.atoms);
  const FileDiagnostics of_names = std::exchange(share.diagnostics, {});
  processes.all_or_throw([&] { require_memory_for(share.total, file, limit, processes); });
  run.atoms = share.total;
  run.read = share.range();
  const LabelTotals labels =
      take_labels(std::exchange(share.residues, {}), outputs, processes, run, share.groups);
  const Box bounds = bounds_of_all(share.atoms, processes);
  processes.all_or_throw([&] { run.whole = plan_grid(bounds, task.parameters); });
  open_checkpoint(task, share, processes, run);
  SlabOfMolecule part = make_slab(std::move(share), run.whole, outputs, run.done,
                                  threads_of(task, machine, processes), processes);
  run.slab = std::move(part.slab);
  run.diagnostics = std::move(part.diagnostics);
  run.diagnostics.add(of_names);
  if (has_names) name_examples(run.names, run.diagnostics);
  if (!outputs.atoms) run.names = {};
  release_free_memory();
  return labels;
}

// Takes a molecule in memory, and makes the grid. Returns its labels.
LabelTotals take_molecule(const Molecule& molecule, const RunTask& task, const Processes& processes,
                          RunPlan& run) {
  require_valid(task.outputs, molecule);
  run.atoms = molecule.atoms().size();
  run.read = {0, run.atoms};
  run.whole = plan_grid(sphere_bounds(molecule.atoms()), task.parameters);
  run.slab.planes = region_planes(run.whole);
  run.slab.molecule = molecule;
  LabelTotals labels;
  if (task.outputs.residues || names_groups(task.outputs))
    labels =
        take_labels(residue_runs(molecule.labels()), task.outputs, processes, run, run.slab.groups);
  if (task.outputs.atoms) labels.atom_text_bytes = total_labels(molecule.labels()).atom_text_bytes;
  return labels;
}

}  // namespace

RunPlan plan_run(const RunTask& task, const Processes& processes) {
  RunPlan run;
  const Processes::Machine machine = processes.machine(available_threads());
  const auto* const file = std::get_if<InputFile>(&task.atoms);
  const LabelTotals labels =
      file != nullptr ? take_file(*file, task, machine, processes, run)
                      : take_molecule(std::get<Molecule>(task.atoms), task, processes, run);
  plan_slab(task, with_labels_held(labels, run), machine, processes, run);
  combine_schedules(processes, run);
  plan_files(run.atoms, sum_labels(labels, processes), task.outputs, run.whole);
  if (!writes_in_place(task, processes)) expect_chunks(task, run.whole);
  return run;
}

bool writes_in_place(const RunTask& task, const Processes& processes) {
  return processes.count() == 1 && !task.resume;
}

}  // namespace eses::detail
