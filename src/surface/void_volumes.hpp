#pragma once
/// Volumes of the voids of cavities.

#include <vector>

#include "eses/measure.hpp"
#include "surface/components.hpp"
#include "surface/measure_patches.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Measures the voids of all cavities, which are the components of a surface from 1. Returns the
/// cavities in this order, with their voids and atoms only.
std::vector<Cavity> measure_voids(const SurfaceModel& surface, const MeasureSettings& settings,
                                  const Components& components);

}  // namespace eses::detail
