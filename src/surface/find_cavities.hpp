#pragma once
/// The cavities of a molecule, found before a sweep that leaves out the filled ones.

#include <memory>

#include "surface/cavity_map.hpp"
#include "surface/measure_settings.hpp"
#include "surface/molecule.hpp"
#include "surface/patch_schedule.hpp"
#include "surface/void_volumes.hpp"

namespace eses::detail {

/// Schedules the patches of a molecule, all of which are needed.
std::shared_ptr<ScheduledSurface> schedule_patches(const Molecule& molecule, double probe_radius);

/// Schedules all patches of a surface. See Patches for `has_bounds`.
std::shared_ptr<ScheduledSurface> schedule_patches(const SurfaceModel& surface, bool has_bounds);

/// The cavities of a molecule.
struct FoundCavities {
  std::shared_ptr<const CavityMap> map;
  /// The surface without filled components, and all its patches if they are kept; else null.
  std::shared_ptr<ScheduledSurface> patches;
};

/// Finds the cavities of a molecule, and fills those up to `max_filled_void`, or all components
/// except `kept_component`. Throws Error if there is no such component. Uses the probe radius, the
/// threads and the callback of the settings. The patches pass in a sweep. With
/// `keeps_patches`, they are kept, and the schedule is at its start.
FoundCavities find_cavities(const Molecule& molecule, const MeasureSettings& settings,
                            bool keeps_patches);

/// Does the same for a surface whose patches have not been built. See measure_voids for `measured`.
std::shared_ptr<const CavityMap> find_cavities(const std::shared_ptr<ScheduledSurface>& surface,
                                               const MeasureSettings& settings,
                                               MeasuredVoids& measured);

}  // namespace eses::detail
