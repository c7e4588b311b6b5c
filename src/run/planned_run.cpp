#include "run/planned_run.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "grid/make_grid.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Memory of the patches of an atom, and of all patches that are kept for the sweep (bytes).
constexpr std::uint64_t kept_patch_bytes = 400;
constexpr std::uint64_t max_kept_bytes = 48 << 20;

FoundCavities find_cavities_of(const Molecule& molecule, const Request& request,
                               bool keeps_patches) {
  const std::optional<MeshOptions>& mesh = request.outputs.mesh;
  std::optional<ComponentNumber> kept;
  if (mesh && mesh->component) kept = ComponentNumber{*mesh->component};
  try {
    return find_cavities(molecule,
                         {.probe_radius = request.parameters.probe_radius,
                          .threads = chosen_threads(request.parameters.threads),
                          .check = request.check,
                          .max_filled_void = request.parameters.max_filled_void,
                          .kept_component = kept},
                         keeps_patches);
  } catch (const Error& error) {
    const auto* const file = std::get_if<InputFile>(&request.atoms);
    if (file == nullptr) throw;
    const auto* const hinted = dynamic_cast<const Hints*>(&error);
    throw HintedError(formatted("{}: {}", file->path.string(), error.what()),
                      hinted != nullptr ? hinted->hints() : std::vector<std::string>());
  }
}

// Finds the cavities of a molecule that a single process has, if the run needs them. A run that
// needs all patches several times keeps them unless there are many. Throws Error, with the path of
// the input file, if the component of the mesh does not exist.
FoundCavities prepare_patches(const Molecule& molecule, const Request& request, const Plan& plan) {
  const Parameters& parameters = request.parameters;
  if (!request.needs_cavities() && !parameters.exact) return {};
  const std::uint64_t bytes = kept_patch_bytes * molecule.atoms().size();
  const bool keeps_patches = plan.is_whole_surface() && bytes <= max_kept_bytes &&
                             (parameters.max_memory == 0 || 8 * bytes <= parameters.max_memory);
  if (request.searches_cavities()) return find_cavities_of(molecule, request, keeps_patches);
  return {nullptr, keeps_patches ? schedule_patches(molecule, parameters.probe_radius) : nullptr};
}

// The planes of a process, the atoms near them, and the cavities with these atoms.
struct SlabWithCavities {
  Slab slab;
  FoundCavities cavities;
};

SlabWithCavities take_whole(InputAtoms& input, const Request& request, const Plan& plan,
                            std::span<const PlaneRange> finished) {
  return {{range_around(remaining(plan.planes(), finished)),
           input.molecule,
           {},
           std::move(input.groups)},
          prepare_patches(input.molecule, request, plan)};
}

// Returns the planes of this process. The planes of parts do not depend on the chunks that happen
// to be complete.
PlaneRange planes_of_share(std::span<const Atom> atoms, const Request& request, const Share& share,
                           const Plan& plan, std::span<const PlaneRange> finished) {
  if (request.part && share.count > plan.planes().count())
    throw HintedError(formatted("{} parts are too many for {} grid planes along z; use fewer parts",
                                share.count, plan.planes().count()),
                      {"part"});
  const std::span<const PlaneRange> free = request.part ? std::span<const PlaneRange>() : finished;
  const std::vector<PlaneRange> slabs = cut_into_slabs(atoms, plan, free, share.count);
  return range_around(remaining(slabs[static_cast<std::size_t>(share.index)], finished));
}

// Gives the cavities the indices of the atoms in the slab.
std::shared_ptr<const CavityMap> with_slab_indices(std::shared_ptr<const CavityMap> cavities,
                                                   const Slab& slab) {
  if (slab.atoms_in_file.empty()) return cavities;
  CavityMap renumbered = *cavities;
  renumbered.renumber([&](AtomIndex atom) -> std::optional<AtomIndex> {
    const auto begin = slab.atoms_in_file.begin(), end = slab.atoms_in_file.end();
    const auto found = std::lower_bound(begin, end, static_cast<FileIndex>(atom));
    if (found == end || *found != static_cast<FileIndex>(atom)) return std::nullopt;
    return static_cast<AtomIndex>(found - begin);
  });
  return std::make_shared<const CavityMap>(std::move(renumbered));
}

// Gives a process its share of the planes and the atoms near them, and finds the cavities, if they
// are needed. Takes the groups of a single process.
SlabWithCavities take_slab(InputAtoms& input, const Request& request, const Share& share,
                           const Plan& plan, std::span<const PlaneRange> finished) {
  if (share.count == 1) return take_whole(input, request, plan, finished);
  const std::span<const Atom> atoms = input.atoms();
  SlabWithCavities part{make_slab(atoms, input.groups, request, plan,
                                  planes_of_share(atoms, request, share, plan, finished)),
                        {}};
  if (request.searches_cavities())
    part.cavities.map =
        with_slab_indices(find_cavities_of(input.molecule, request, false).map, part.slab);
  return part;
}

// Throws Error if reading and indexing the atoms has exceeded the memory limit.
void require_memory_held(const InputFile& file, std::uint64_t limit) {
  const std::uint64_t peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw LimitExceeded(
      formatted("{}: reading the atoms took {} of memory, but the limit is {}; use a larger limit",
                file.path.string(), binary_bytes_text(peak), binary_bytes_text(limit)));
}

// Chooses the schedule of this process for its slab. `sharing` is the number of processes on this
// machine. Kept patches are dropped if the memory limit excludes them: the minimum limit in
// messages is without them.
Schedule schedule_slab(const Slab& slab, const Request& request, const InputInfo& input,
                       const Plan& plan, std::uint64_t sharing, const Processes& processes,
                       std::shared_ptr<ScheduledSurface>& kept_patches) {
  const auto schedule = [&] {
    const std::uint64_t of_patches =
        kept_patches ? kept_patch_bytes * slab.molecule.atoms().size() : 0;
    return plan_schedule({.available = [sharing] { return available_memory() / sharing; },
                          .held = processes.mpi_memory() + input.bytes() + of_patches +
                                  memory_of_labels(slab.molecule.labels()),
                          .labels = input.labels,
                          .has_groups = input.groups.are_known,
                          .makes_maps = processes.is_first() && !request.part},
                         slab.molecule, request, plan, slab.planes);
  };
  try {
    return schedule();
  } catch (const LimitExceeded&) {
    if (!kept_patches) throw;
    kept_patches = {};
    release_free_memory();
    return schedule();
  }
}

// Returns the schedule of a process without planes.
Schedule empty_schedule(const Parameters& parameters) {
  return {.tiling = {},
          .threads = parameters.threads == 0 ? available_threads() : 1,
          .blocks_ahead = 0,
          .crossings = 0,
          .memory_bytes = 0};
}

// Returns the largest schedule of all processes, and the crossings of all.
Schedule largest_of(const Schedule& own, const Plan& plan, const Processes& processes) {
  GridIndex block_size = own.tiling.block_size;
  for (std::int64_t& side : block_size) side = processes.max(side);
  return {.tiling = make_tiling(plan.grid, block_size, plan.region),
          .threads = processes.max(own.threads),
          .blocks_ahead = processes.max(own.blocks_ahead),
          .crossings = processes.sum(own.crossings),
          .memory_bytes = processes.max(own.memory_bytes)};
}

}  // namespace

PlannedRun plan_run(Request request, const Processes& processes) {
  const Processes::Machine machine = processes.machine(available_threads());
  Parameters& parameters = request.parameters;
  if (parameters.threads == 0 && processes.count() > 1) parameters.threads = machine.processors;
  const Share share = request.part.value_or(Share{processes.rank(), processes.count()});
  const auto* const file = std::get_if<InputFile>(&request.atoms);

  InputAtoms all = take_input(request, share, processes);
  const Plan plan =
      processes.all_or_throw([&] { return plan_grid(sphere_bounds(all.atoms()), parameters); });
  OpenCheckpoint opened = open_checkpoint(all, request, plan, processes);
  SlabWithCavities part =
      processes.all_or_throw([&] { return take_slab(all, request, share, plan, opened.finished); });
  InputInfo input =
      kept_info(std::move(all), part.slab.molecule.atoms().size(), request.outputs, processes);
  if (file != nullptr) release_free_memory();

  const Schedule schedule = processes.all_or_throw([&] {
    if (part.slab.planes.is_empty()) return empty_schedule(parameters);
    const Schedule chosen = schedule_slab(part.slab, request, input, plan,
                                          static_cast<std::uint64_t>(machine.processes), processes,
                                          part.cavities.patches);
    if (file != nullptr) require_memory_held(*file, parameters.max_memory);
    return chosen;
  });
  const Schedule largest = largest_of(schedule, plan, processes);
  const FileSizes sizes = plan_files(input.atom_count, input.labels, request,
                                     opened.checkpoint != nullptr, plan, largest);
  return {.request = std::move(request),
          .share = share,
          .input = std::move(input),
          .plan = plan,
          .checkpoint = std::move(opened.checkpoint),
          .finished_planes = std::move(opened.finished),
          .slab = std::move(part.slab),
          .cavities = std::move(part.cavities),
          .schedule = schedule,
          .largest_schedule = largest,
          .file_sizes = sizes};
}

std::shared_ptr<ScheduledSurface> surface_of(const PlannedRun& run) {
  if (run.cavities.patches) return run.cavities.patches;
  const Box slab = slab_box(run.plan, run.slab.planes);
  SurfaceModel surface(run.slab.molecule, run.request.parameters.probe_radius);
  surface.cavities = run.filled();
  if (!run.plan.is_whole_surface() || run.slab.planes != run.plan.planes())
    surface.confine_to(slab);
  return std::make_shared<ScheduledSurface>(std::move(surface),
                                            HeightRange{slab.low.z, slab.high.z});
}

}  // namespace eses::detail
