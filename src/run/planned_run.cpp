#include "run/planned_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "geometry/box.hpp"
#include "geometry/make_grid.hpp"
#include "geometry/region_box.hpp"
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

// Returns the planes from the first to the last one of these ranges.
PlaneRange range_around(std::span<const PlaneRange> ranges) {
  return ranges.empty() ? PlaneRange{} : PlaneRange{ranges.front().begin, ranges.back().end};
}

// Costs in units of a grid point, measured with proteins that are written with all outputs:
// building the patches of an atom, and a crossing.
constexpr double cost_of_atom = 5000, cost_of_crossing = 300;
// The fraction of the area of a protein's atoms that is part of its surface.
constexpr double exposed_fraction = 0.1;

// Maximum number of bins of planes. It limits the memory for grids with very many planes.
constexpr std::int64_t max_bins = 1 << 16;

// Divides planes into bins of nearly equal numbers, and returns the begin of each and the end.
std::vector<std::int64_t> bins_of(const PlaneRange& planes) {
  const std::int64_t count = std::min(planes.count(), max_bins);
  std::vector<std::int64_t> begins;
  for (std::int64_t bin = 0; bin <= count; ++bin)
    begins.push_back(planes.begin + static_cast<std::int64_t>(static_cast<double>(planes.count()) *
                                                              static_cast<double>(bin) /
                                                              static_cast<double>(count)));
  return begins;
}

// Returns the costs of the bins, without those of finished planes. The cost of an atom is spread
// over its height.
std::vector<double> estimate_costs(std::span<const Atom> atoms, const Plan& plan,
                                   std::span<const std::int64_t> begins,
                                   std::span<const PlaneRange> finished) {
  const Grid& grid = plan.grid;
  const auto bin_of = [&](double z) {
    const double plane =
        std::clamp(std::round((z - grid.origin.z) / grid.spacing),
                   static_cast<double>(begins.front()), static_cast<double>(begins.back() - 1));
    return std::ranges::upper_bound(begins, static_cast<std::int64_t>(plane)) - begins.begin() - 1;
  };
  std::vector<double> costs(begins.size());  // differences of consecutive bins
  for (const auto& [center, radius] : atoms) {
    const auto begin = bin_of(center.z - radius), end = bin_of(center.z + radius) + 1;
    const double area = exposed_fraction * 4 * std::numbers::pi * radius * radius;
    const double cost = (cost_of_atom + cost_of_crossing * expected_crossings(area, grid.spacing)) /
                        static_cast<double>(end - begin);
    costs[static_cast<std::size_t>(begin)] += cost;
    costs[static_cast<std::size_t>(end)] -= cost;
  }
  costs.pop_back();
  std::partial_sum(costs.begin(), costs.end(), costs.begin());
  const GridIndex size = plan.region.size();
  for (std::size_t b = 0; b < costs.size(); ++b) {
    const PlaneRange planes{begins[b], begins[b + 1]};
    const auto all = static_cast<double>(planes.count());
    costs[b] = (std::max(0.0, costs[b]) + static_cast<double>(size[0] * size[1]) * all) *
               static_cast<double>(plane_count(remaining(planes, finished))) / all;
  }
  return costs;
}

// Returns the maximum distance from a slab at which an atom influences it: the distance of Reach
// for the patches, plus the distance at which SAS spheres meet. For the map of ion access it is at
// least the ion radius.
double influence(const Atom& atom, double max_radius, const Request& request) {
  constexpr double slack = 1;  // angstrom
  const std::optional<IonAccessMap>& ions = request.outputs.ion_access;
  return atom.radius + slack +
         std::max(4 * max_radius + 6 * request.parameters.probe_radius,
                  ions ? ions->ion_radius : 0);
}

// Returns the slabs of `count` processes in the region of `plan`. The planes in `finished`
// (ascending, disjoint) cost nothing and are at no end of a slab. Slabs without unfinished planes
// are empty.
std::vector<PlaneRange> cut_into_slabs(std::span<const Atom> atoms, const Plan& plan,
                                       std::span<const PlaneRange> finished, int count) {
  const std::vector<std::int64_t> bins = bins_of(plan.planes());
  const std::vector<double> costs = estimate_costs(atoms, plan, bins, finished);
  std::vector<std::size_t> begins = cut_evenly(costs, count);
  const auto all = static_cast<std::size_t>(count);
  for (std::size_t i = 1; i < all && all <= costs.size(); ++i)
    begins[i] = std::clamp(begins[i], begins[i - 1] + 1, costs.size() - (all - i));
  std::vector<PlaneRange> slabs;
  for (std::size_t slab = 0; slab + 1 < begins.size(); ++slab)
    slabs.push_back(
        range_around(remaining({bins[begins[slab]], bins[begins[slab + 1]]}, finished)));
  return slabs;
}

// Makes a slab of these planes from all atoms and their groups.
Slab make_slab(std::span<const Atom> atoms, std::span<const GroupNumbers> groups,
               const Request& request, const Plan& plan, const PlaneRange& planes) {
  Slab slab;
  slab.planes = planes;
  if (planes.is_empty()) return slab;
  double max_radius = 0;
  for (const Atom& atom : atoms) max_radius = std::max(max_radius, atom.radius);
  // With the plane below, and with the plane above, where edges of the slab end.
  const double low = plan.grid.coordinate(2, planes.begin - 1);
  const double high = plan.grid.coordinate(2, planes.end);
  std::vector<Atom> near;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const Atom& atom = atoms[i];
    const double reach = influence(atom, max_radius, request);
    // The first atom is in all slabs, so that each of them has an atom.
    if (i > 0 && (atom.center.z < low - reach || atom.center.z > high + reach)) continue;
    near.push_back(atom);
    slab.atoms_in_file.push_back(static_cast<FileIndex>(i));
    if (!groups.empty()) slab.groups.push_back(groups[i]);
  }
  slab.molecule = Molecule(std::move(near), {}, request.parameters.threads);
  return slab;
}

// Throws Error if there are more parts than planes, before anything is written.
void require_enough_planes(const std::optional<Share>& part, const Plan& plan) {
  if (part && part->count > plan.planes().count())
    throw HintedError(formatted("{} parts are too many for {} grid planes along z; use fewer parts",
                                part->count, plan.planes().count()),
                      {"part"});
}

// Returns the planes of this process. The planes of parts do not depend on the chunks that happen
// to be complete.
PlaneRange planes_of_share(std::span<const Atom> atoms, const Request& request, const Share& share,
                           const Plan& plan, std::span<const PlaneRange> finished) {
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

// Returns the slab of a process, with the cavities if they are needed. A single process takes the
// groups.
Slab take_slab(InputAtoms& input, const Request& request, const Share& share, const Plan& plan,
               std::span<const PlaneRange> finished) {
  if (share.count == 1) {
    // g++ 12 destroys the molecule twice if a later member of a braced list throws.
    auto cavities = prepare_patches(input.molecule, request, plan);
    return {range_around(remaining(plan.planes(), finished)),
            input.molecule,
            {},
            std::move(input.groups),
            std::move(cavities)};
  }
  const std::span<const Atom> atoms = input.atoms();
  Slab slab = make_slab(atoms, input.groups, request, plan,
                        planes_of_share(atoms, request, share, plan, finished));
  if (request.searches_cavities())
    slab.cavities.map =
        with_slab_indices(find_cavities_of(input.molecule, request, false).map, slab);
  return slab;
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
Schedule schedule_slab(Slab& slab, const Request& request, const InputInfo& input, const Plan& plan,
                       std::uint64_t sharing, const Processes& processes) {
  std::shared_ptr<ScheduledSurface>& kept_patches = slab.cavities.patches;
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

// Returns the box of the points of these planes, of the edges that start there, and of the plane
// of the region below them.
Box slab_box(const Plan& plan, const PlaneRange& planes) {
  const std::int64_t begin = std::max(planes.begin - 1, plan.region.begin[2]);
  return region_box(plan.grid, with_planes(plan.region, {begin, planes.end}));
}

}  // namespace

std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts) {
  std::vector<double> sums(costs.size() + 1, 0);
  std::partial_sum(costs.begin(), costs.end(), sums.begin() + 1);
  std::vector<std::size_t> begins{0};
  for (int part = 1; part < parts; ++part) {
    const double wanted = sums.back() * part / parts;
    auto cut = std::lower_bound(sums.begin(), sums.end(), wanted);
    // Chooses the nearer of the two sums around the wanted one.
    if (cut != sums.begin() && wanted - *(cut - 1) < *cut - wanted) --cut;
    begins.push_back(std::max(begins.back(), static_cast<std::size_t>(cut - sums.begin())));
  }
  begins.push_back(costs.size());
  return begins;
}

std::int64_t plane_count(std::span<const PlaneRange> ranges) {
  return std::accumulate(
      ranges.begin(), ranges.end(), std::int64_t{0},
      [](std::int64_t sum, const PlaneRange& planes) { return sum + planes.count(); });
}

PlannedRun plan_run(Request request, const Processes& processes) {
  const Processes::Machine machine = processes.machine(available_threads());
  Parameters& parameters = request.parameters;
  if (parameters.threads == 0 && processes.count() > 1) parameters.threads = machine.processors;
  const Share share = request.part.value_or(Share{processes.rank(), processes.count()});
  const auto* const file = std::get_if<InputFile>(&request.atoms);

  InputAtoms all = take_input(request, share, processes);
  const Plan plan = processes.all_or_throw([&] {
    const Plan of_atoms = plan_grid(sphere_bounds(all.atoms()), parameters);
    require_enough_planes(request.part, of_atoms);
    return of_atoms;
  });
  OpenCheckpoint opened = open_checkpoint(all, request, plan, processes);
  Slab slab =
      processes.all_or_throw([&] { return take_slab(all, request, share, plan, opened.finished); });
  InputInfo input =
      kept_info(std::move(all), slab.molecule.atoms().size(), request.outputs, processes);
  if (file != nullptr) release_free_memory();

  const Schedule schedule = processes.all_or_throw([&] {
    if (slab.planes.is_empty()) return empty_schedule(parameters);
    const Schedule chosen = schedule_slab(slab, request, input, plan,
                                          static_cast<std::uint64_t>(machine.processes), processes);
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
          .slab = std::move(slab),
          .schedule = schedule,
          .largest_schedule = largest,
          .file_sizes = sizes};
}

std::shared_ptr<ScheduledSurface> surface_of(const PlannedRun& run) {
  if (run.slab.cavities.patches) return run.slab.cavities.patches;
  const Box slab = slab_box(run.plan, run.slab.planes);
  SurfaceModel surface(run.slab.molecule, run.request.parameters.probe_radius);
  surface.cavities = run.slab.filled();
  if (!run.plan.is_whole_surface() || run.slab.planes != run.plan.planes())
    surface.confine_to(slab);
  return std::make_shared<ScheduledSurface>(std::move(surface),
                                            HeightRange{slab.low.z, slab.high.z});
}

}  // namespace eses::detail
