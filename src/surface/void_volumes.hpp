#pragma once
/// Volumes of the voids of cavities.

#include <vector>

#include "eses/measure.hpp"
#include "surface/components.hpp"
#include "surface/measure_patches.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// The last measurement of voids. The surfaces of a molecule with and without slack and shrinkage
/// mostly have the same atoms around their cavities, and need one measurement of voids.
struct MeasuredVoids {
  std::vector<AtomIndex> atoms;  ///< those that were measured
  std::vector<Cavity> cavities;  ///< all cavities of these atoms
};

/// Measures the voids of all cavities, which are the components of a surface from 1. Returns the
/// cavities in this order, with their voids and atoms only. `measured` is of the same molecule and
/// settings, or empty.
std::vector<Cavity> measure_voids(const SurfaceModel& surface, const MeasureSettings& settings,
                                  const Components& components, MeasuredVoids& measured);

}  // namespace eses::detail
