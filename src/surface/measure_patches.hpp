#pragma once
/// Areas and volumes from the patches of a molecule, in a sweep along z.

#include <memory>
#include <optional>
#include <span>

#include "eses/measure.hpp"
#include "surface/cavity_map.hpp"
#include "surface/components.hpp"
#include "surface/molecule.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Settings of measure_patches. See MeasureOptions.
struct MeasureSettings {
  double probe_radius = 0;
  bool by_atom = false;
  bool gradients = false;
  std::span<const double> weights = {};
  bool cavities = false;
  int threads = 1;
  CheckCallback check = {};
  /// Maximum void of the cavities that are filled (cubic angstrom); none are filled without a
  /// value.
  std::optional<double> max_filled_void = {};
  /// The only component that is not filled, by its number; only for find_cavities.
  std::optional<ComponentNumber> kept_component = {};
  bool largest_probes = true;  ///< whether to find the largest probe of each cavity
};

/// Measures the surface for one probe radius. Leaves the values of the van der Waals surface 0.
Measures measure_patches(const Molecule& molecule, const MeasureSettings& settings);

/// Schedules the patches of a molecule, all of which are needed.
std::shared_ptr<ScheduledSurface> schedule_patches(const Molecule& molecule, double probe_radius);

/// Does the same as measure_patches with patches that another sweep uses later. They are kept, and
/// the schedule is at its start then. The settings must agree with the surface.
Measures measure_kept_patches(const std::shared_ptr<ScheduledSurface>& kept,
                              const MeasureSettings& settings);

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

/// Returns the components of the set of accessible probe centres.
Components find_components(const Molecule& molecule, const MeasureSettings& settings);

}  // namespace eses::detail
