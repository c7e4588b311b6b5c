#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "compute/joint_run.hpp"
#include "eses/version.hpp"
#include "mesh/mesh_writer.hpp"
#include "output/inside_map.hpp"
#include "plan/atom_hash.hpp"
#include "plan/plan.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/splitmix64.hpp"

namespace eses {
namespace {

// To be raised with every change of what is computed, or of how pieces are kept.
constexpr int piece_format = 2;

// The same whoever reads which atoms.
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

// The same whoever has which names.
std::uint64_t hash_of(const OwnGroups& groups, const Processes& processes) {
  std::uint64_t sum = 0, number = groups.first_residue;
  for (const AtomLabel& label : groups.residues) {
    uLong hash = 0;
    for (const std::string* const text : {&label.chain, &label.residue, &label.residue_number})
      hash = crc32_z(hash, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    sum += splitmix64(hash ^ number++ << 32);
  }
  return processes.sum(sum);
}

std::string mesh_identity(const std::optional<MeshChoice>& mesh) {
  if (!mesh) return "none";
  return fmt::format("{} {}", static_cast<int>(mesh_format(mesh->file).value()),
                     static_cast<int>(mesh->color));
}

std::string identity_of(const JointTask& task, const JointPlan& joint, std::uint64_t hash) {
  const Parameters& p = task.parameters;
  const GridRegion& region = joint.whole.tiling.region;
  return fmt::format(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "points {} {}\ngrid {} edges {} gzip {} map {} mesh {}\n",
      version, piece_format, sizeof(PieceInfo), task.outputs.gzip ? zlibVersion() : "", joint.atoms,
      hash, p.probe_radius, p.spacing, p.margin, fmt::join(region.begin, " "),
      fmt::join(region.end, " "), task.outputs.grid, task.outputs.edges, task.outputs.gzip,
      !task.outputs.inside_map.empty(), mesh_identity(task.outputs.mesh));
}

SphereBounds shared_bounds(const AtomShare& share, const Processes& processes) {
  const SphereBounds own = sphere_bounds(share.atoms);
  std::array<double, 3> low{own.low.x, own.low.y, own.low.z};
  std::array<double, 3> high{own.high.x, own.high.y, own.high.z};
  processes.take_least(low);
  processes.take_largest(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

int threads_of(const JointTask& task, const Processes::Machine& machine) {
  return task.parameters.threads > 0 ? task.parameters.threads : machine.processors;
}

// What this process is to do; nothing where its slab is empty.
Plan plan_slab(const JointTask& task, const JointPlan& joint, const LabelTotals& labels,
               const Processes::Machine& machine, const Processes& processes) {
  Plan own = joint.whole;
  own.tiling.region.begin[2] = joint.slab.planes.begin;
  own.tiling.region.end[2] = joint.slab.planes.end;
  own.parameters.threads = threads_of(task, machine);
  processes.agree([&] {
    if (joint.slab.planes.is_empty()) return;
    plan_work({.available = available_memory() / static_cast<std::uint64_t>(machine.processes),
               .held = processes.own_memory(),
               .labels = labels},
              joint.slab.molecule, task.outputs, own);
  });
  return own;
}

// What this process has read of labels, and what it goes on holding.
LabelTotals labels_of(const OwnGroups& groups, const ResidueRuns& read,
                      const OutputChoice& outputs) {
  LabelTotals totals = total_labels(read.labels);
  if (!outputs.residues) {
    totals.labels = 0;
    totals.heap_bytes = 0;
  }
  for (const auto* const names : {&groups.chains, &groups.residues}) {
    totals.labels += names->size();
    totals.heap_bytes += total_labels(*names).heap_bytes;
  }
  // Atoms have numbers of groups, also where none comes first.
  if (groups.are_known) ++totals.labels;
  return totals;
}

// The largest of the processes' schedules.
void choose_schedule(Plan& whole, const Plan& own, const Processes& processes) {
  const GridRegion region = whole.tiling.region;
  const GridIndex& block_size = own.tiling.block_size;
  std::array<std::uint64_t, 6> largest{own.memory_bytes,
                                       static_cast<std::uint64_t>(own.blocks_ahead),
                                       static_cast<std::uint64_t>(own.threads),
                                       static_cast<std::uint64_t>(block_size[0]),
                                       static_cast<std::uint64_t>(block_size[1]),
                                       static_cast<std::uint64_t>(block_size[2])};
  processes.take_largest(largest);
  whole.memory_bytes = largest[0];
  whole.blocks_ahead = static_cast<std::int64_t>(largest[1]);
  whole.threads = static_cast<int>(largest[2]);
  const auto side = [&](std::size_t axis) { return static_cast<std::int64_t>(largest[3 + axis]); };
  whole.tiling = make_tiling(whole.grid, GridIndex{side(0), side(1), side(2)}, region);
}

// Of all processes together; crossings and triangles of what is still to be done.
void expect_files(const JointTask& task, const LabelTotals& labels, JointPlan& plan,
                  const Processes& processes) {
  const OutputChoice& outputs = task.outputs;
  Plan& whole = plan.whole;
  const GridRegion& region = whole.tiling.region;
  std::array sums{plan.own.edge_file_bytes, plan.own.mesh_file_bytes, expected_table_bytes(labels)};
  processes.add(sums);
  whole.gzip = outputs.gzip;
  whole.edge_file_bytes = sums[0];
  whole.mesh_file_bytes = sums[1];
  if (outputs.residues) whole.residue_file_bytes = sums[2];
  if (outputs.box) whole.box_file_bytes = expected_box_bytes(whole.grid, outputs.gzip);
  if (outputs.grid) whole.grid_file_bytes = expected_grid_bytes(region, outputs.gzip);
  if (outputs.areas) whole.area_file_bytes = expected_area_bytes(plan.atoms, outputs.gzip);
  whole.text_scratch_bytes = whole.grid_file_bytes + whole.edge_file_bytes;
  // Pieces that are kept are all in one place, others beside their files.
  (task.resume ? whole.text_scratch_bytes : whole.mesh_scratch_bytes) += whole.mesh_file_bytes;
  if (outputs.inside_map.empty()) return;
  expect_map(outputs.inside_map, whole);
  whole.text_scratch_bytes += InsideMap::bits_bytes(region);
}

bool has_names(const OutputChoice& outputs) {
  return outputs.mesh && mesh::names_atoms(*outputs.mesh);
}

}  // namespace

JointPlan plan_jointly(const JointTask& task, const Processes& processes) {
  const OutputChoice& outputs = task.outputs;
  AtomShare share = read_share(task.input,
                               {.format = task.format,
                                .with_labels = outputs.residues || has_names(outputs),
                                .max_memory = task.parameters.max_memory},
                               processes);
  JointPlan plan;
  plan.atoms = share.total;
  plan.read = share.range();
  if (has_names(outputs)) {
    plan.groups = number_groups(share, processes);
    release_free_memory();
  }
  const LabelTotals labels = labels_of(plan.groups, share.residues, outputs);
  if (outputs.residues) plan.residues = std::move(share.residues);
  share.residues = {};
  const SphereBounds bounds = shared_bounds(share, processes);
  std::uint64_t hash = 0;
  if (task.resume) hash = hash_of(share, processes) ^ hash_of(plan.groups, processes);
  std::vector<PlaneRange> done;
  processes.agree([&] {
    plan.whole = plan_grid(bounds, task.parameters);
    if (!task.resume) return;
    plan.store = std::make_unique<PieceStore>(task.output_directory, identity_of(task, plan, hash));
    if (!processes.is_first()) return;
    if (!task.dry_run) plan.store->lock();
    done = plan.store->complete();
    if (!task.dry_run) plan.store->remove_others(done);
  });
  plan.done = processes.gather<PlaneRange>(done);
  const Processes::Machine machine = processes.machine(available_threads());
  SharedMolecule shared =
      share_molecule(share, plan.whole, outputs, plan.done, threads_of(task, machine), processes);
  share = {};
  plan.slab = std::move(shared.slab);
  plan.odd = std::move(shared.odd);
  plan.own = plan_slab(task, plan, labels, machine, processes);
  choose_schedule(plan.whole, plan.own, processes);
  expect_files(task, labels, plan, processes);
  return plan;
}

}  // namespace eses
