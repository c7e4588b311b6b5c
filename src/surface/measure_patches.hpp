#pragma once
/// Areas and volumes from the patches of a molecule, in a sweep along z.

#include <memory>

#include "eses/measure.hpp"
#include "surface/components.hpp"
#include "surface/measure_settings.hpp"
#include "surface/molecule.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Measures the surface for one probe radius. Leaves the values of the van der Waals surface 0.
/// Throws Error if the patches do not fit together, see closure.hpp.
Measures measure_patches(const Molecule& molecule, const MeasureSettings& settings);

/// Measures only the SAS, much faster: areas and volume. The settings must not ask for more. The
/// patches are measured if rounding may decide, and if cavities are filled.
Measures measure_sas(const Molecule& molecule, const MeasureSettings& settings);

/// Does the same as measure_patches with patches that another sweep uses later. They are kept, and
/// the schedule is at its start then. The settings must agree with the surface.
Measures measure_kept_patches(const std::shared_ptr<ScheduledSurface>& kept,
                              const MeasureSettings& settings);

/// Returns the surface without slack whose patches fit together best. See SurfaceModel.
SurfaceModel consistent_surface(const Molecule& molecule, const MeasureSettings& settings);

/// Returns the components of the set of accessible probe centres.
Components find_components(const Molecule& molecule, const MeasureSettings& settings);

}  // namespace eses::detail
