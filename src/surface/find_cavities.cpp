#include "surface/find_cavities.hpp"

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "surface/atom_loops.hpp"
#include "surface/cavity_list.hpp"
#include "surface/cluster_terms.hpp"
#include "surface/measure_patches.hpp"
#include "surface/near_origin.hpp"
#include "surface/patch_sweep.hpp"

namespace eses::detail {
namespace {

// Called between steps that take tenths of a second for a million atoms.
void check(const MeasureSettings& settings) {
  if (settings.check) settings.check();
}

// Finds the components of a surface, without the sums over faces. Returns nothing if a decision
// about its patches depends on the slack. All patches pass in any case.
std::optional<Components> sweep_components(const std::shared_ptr<ScheduledSurface>& surface,
                                           const MeasureSettings& settings) {
  PatchSweep sweep(surface, {0, true, false}, settings.threads, settings.check);
  ComponentFinder finder(surface->surface, middle_of(surface->surface.atoms));
  std::vector<ComponentFinder::RootSums> roots;
  ClusterScratch scratch;
  bool is_consistent = true;
  sweep.run([&](const SweepLayer& layer) {
    const Patches& patches = surface->schedule.patches();
    for (ClusterIndex k = layer.begin; k < layer.end && surface->surface.has_slack; ++k)
      is_consistent = is_consistent && is_regular(surface->surface, patches.of_cluster(k), scratch);
    if (!is_consistent) return true;
    finder.begin_layer(layer);
    for (ClusterIndex cluster = layer.begin; cluster < layer.end; ++cluster) {
      roots.clear();
      for (PlacementNumber k = layer.placements.first_of_cluster(cluster);
           k < layer.placements.end_of_cluster(cluster); ++k) {
        const ComponentFinder::Node root = finder.root_of_placement(k);
        sums_of(roots, root).box.include(layer.placements.center(k));
        finder.keep(root, layer.placements.center(k));
      }
      for (const ComponentFinder::RootSums& sums : roots) finder.add(sums);
    }
    finder.end_layer();
    return true;
  });
  if (!is_consistent) return std::nullopt;
  check(settings);
  return finder.finish({}, settings.check);
}

// Finds the cavities of a molecule far away from the origin, as for measures. The patches of the
// molecule are others than those near the origin, because rounding moves them.
FoundCavities find_far_cavities(const Molecule& molecule, const MeasureSettings& settings,
                                bool keeps_patches) {
  const MovedMolecule moved = near_origin(molecule, settings.threads);
  CavityMap map = *find_cavities(moved.molecule, settings, false).map;
  map.move(moved.offset);
  FoundCavities found{std::make_shared<const CavityMap>(std::move(map)), nullptr};
  if (!keeps_patches) return found;
  SurfaceModel surface(molecule, settings.probe_radius);
  if (found.map->has_filled()) surface.cavities = found.map;
  found.patches = schedule_patches(surface, true);
  return found;
}

}  // namespace

std::shared_ptr<ScheduledSurface> schedule_patches(const SurfaceModel& surface, bool has_bounds) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return std::make_shared<ScheduledSurface>(surface, HeightRange{-infinity, infinity}, has_bounds);
}

std::shared_ptr<ScheduledSurface> schedule_patches(const Molecule& molecule, double probe_radius) {
  return schedule_patches(SurfaceModel(molecule, probe_radius), true);
}

std::shared_ptr<const CavityMap> find_cavities(const std::shared_ptr<ScheduledSurface>& surface,
                                               const MeasureSettings& settings,
                                               MeasuredVoids& measured) {
  const SurfaceModel& model = surface->surface;
  const std::optional<Components> components = sweep_components(surface, settings);
  if (!components)
    return find_cavities(schedule_patches(consistent_surface(model.molecule, settings), false),
                         settings, measured);
  check(settings);
  const std::vector<Cavity> cavities = measure_voids(model, settings, *components, measured);
  check(settings);
  std::vector<ComponentNumber> number_of(components->count);
  std::vector<double> volumes;
  for (const std::size_t c : order_by_void(cavities)) {
    volumes.push_back(cavities[c].void_volume);
    number_of[c + 1] = static_cast<ComponentNumber>(volumes.size());
  }
  const auto map = std::make_shared<CavityMap>(model, *components, number_of, std::move(volumes),
                                               settings.check);
  check(settings);
  if (settings.max_filled_void) map->fill(*settings.max_filled_void);
  if (settings.kept_component) map->keep_only(*settings.kept_component);
  return map;
}

FoundCavities find_cavities(const Molecule& molecule, const MeasureSettings& settings,
                            bool keeps_patches) {
  if (is_far_away(molecule)) return find_far_cavities(molecule, settings, keeps_patches);
  check(settings);
  auto surface = schedule_patches(SurfaceModel(molecule, settings.probe_radius), keeps_patches);
  check(settings);
  if (keeps_patches) surface->schedule.keep_passed();
  MeasuredVoids measured;
  FoundCavities found{find_cavities(surface, settings, measured), nullptr};
  if (!keeps_patches) return found;
  surface->schedule.rewind();
  if (found.map->has_filled()) {
    surface->surface.cavities = found.map;
    Patches& patches = surface->schedule.patches();
    for_each_index(patches.clusters().count(), settings.threads, [&](std::size_t cluster) {
      patches.drop_filled(static_cast<ClusterIndex>(cluster));
    });
  }
  found.patches = std::move(surface);
  return found;
}

}  // namespace eses::detail
