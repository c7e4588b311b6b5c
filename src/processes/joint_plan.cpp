#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "eses/version.hpp"
#include "processes/joint_run.hpp"
#include "run/parallel.hpp"
#include "run/plan.hpp"
#include "run/resources.hpp"
#include "verify/scrambled.hpp"

namespace eses {
namespace {

// To be raised with every change of what is computed, or of how pieces are kept.
constexpr int piece_format = 1;

// The same whoever reads which atoms.
std::uint64_t hash_of(const AtomShare& share, const Processes& processes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < share.atoms.size(); ++i) {
    const auto& [center, radius] = share.atoms[i];
    std::uint64_t hash = scrambled(share.first + i);
    for (const double value : {center.x, center.y, center.z, radius})
      hash = scrambled(hash ^ std::bit_cast<std::uint64_t>(value));
    sum += hash;
  }
  return processes.sum(sum);
}

std::string identity_of(const JointTask& task, const Plan& plan, std::uint64_t atoms,
                        std::uint64_t hash) {
  const Parameters& p = task.parameters;
  const GridRegion& region = plan.tiling.region;
  return fmt::format(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "points {} {}\ngrid {} edges {} gzip {}\n",
      version, piece_format, sizeof(PieceInfo), task.outputs.gzip ? zlibVersion() : "", atoms, hash,
      p.probe_radius, p.spacing, p.margin, fmt::join(region.begin, " "), fmt::join(region.end, " "),
      task.outputs.grid, task.outputs.edges, task.outputs.gzip);
}

SphereBounds shared_bounds(const AtomShare& share, const Processes& processes) {
  const SphereBounds own = sphere_bounds(share.atoms);
  std::array<double, 3> low{own.low.x, own.low.y, own.low.z};
  std::array<double, 3> high{own.high.x, own.high.y, own.high.z};
  processes.take_least(low);
  processes.take_largest(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

// What this process is to do; nothing where its slab is empty.
Plan plan_slab(const JointTask& task, const JointPlan& joint, const Processes& processes) {
  const Processes::Machine machine = processes.machine(available_threads());
  Plan own = joint.whole;
  own.tiling.region.begin[2] = joint.slab.planes.begin;
  own.tiling.region.end[2] = joint.slab.planes.end;
  if (own.parameters.threads == 0) own.parameters.threads = machine.processors;
  processes.agree([&] {
    if (joint.slab.planes.is_empty()) return;
    plan_work(available_memory() / static_cast<std::uint64_t>(machine.processes),
              joint.slab.molecule, task.outputs, own);
  });
  return own;
}

// Sums and maxima of the processes' plans.
void complete(Plan& whole, const Plan& own, std::uint64_t atoms, const OutputChoice& outputs,
              const Processes& processes) {
  const GridRegion region = whole.tiling.region;
  std::array<std::uint64_t, 5> largest{
      own.memory_bytes, own.box_file_bytes, static_cast<std::uint64_t>(own.tiling.block_size),
      static_cast<std::uint64_t>(own.blocks_ahead), static_cast<std::uint64_t>(own.threads)};
  processes.take_largest(largest);
  whole.memory_bytes = largest[0];
  whole.box_file_bytes = largest[1];
  whole.tiling = make_tiling(whole.grid, static_cast<std::int64_t>(largest[2]), region);
  whole.blocks_ahead = static_cast<std::int64_t>(largest[3]);
  whole.threads = static_cast<int>(largest[4]);
  whole.gzip = outputs.gzip;
  if (outputs.grid) whole.grid_file_bytes = expected_grid_bytes(region, outputs.gzip);
  whole.edge_file_bytes = processes.sum(own.edge_file_bytes);  // of what is still to be done
  if (outputs.areas) whole.area_file_bytes = expected_area_bytes(atoms, outputs.gzip);
  whole.text_scratch_bytes = whole.grid_file_bytes + whole.edge_file_bytes;
}

}  // namespace

JointPlan plan_jointly(const JointTask& task, const Processes& processes) {
  AtomShare share = read_share(task.input, task.format, processes);
  JointPlan plan;
  plan.atoms = share.total;
  const SphereBounds bounds = shared_bounds(share, processes);
  const std::uint64_t hash = task.resume ? hash_of(share, processes) : 0;
  std::vector<PlaneRange> done;
  processes.agree([&] {
    plan.whole = plan_grid(bounds, task.parameters);
    if (!task.resume) return;
    plan.store = std::make_unique<PieceStore>(task.output_directory,
                                              identity_of(task, plan.whole, plan.atoms, hash));
    if (!processes.is_first()) return;
    if (!task.dry_run) plan.store->lock();
    done = plan.store->complete();
  });
  plan.done = processes.gather<PlaneRange>(done);
  SharedMolecule shared = share_molecule(share, plan.whole, task.outputs, plan.done, processes);
  share = {};
  plan.slab = std::move(shared.slab);
  plan.odd = std::move(shared.odd);
  plan.own = plan_slab(task, plan, processes);
  complete(plan.whole, plan.own, plan.atoms, task.outputs, processes);
  return plan;
}

}  // namespace eses
