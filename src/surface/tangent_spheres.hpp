#pragma once
/// SAS spheres that just touch, where areas have a kink.

#include "geometry/tolerances.hpp"
#include "surface/gradient_terms.hpp"
#include "surface/patches.hpp"

namespace eses::detail {

/// SAS spheres that overlap by at most this separate if the probe is smaller by
/// tolerance::accessible. There are no derivatives for their circle (angstrom).
inline constexpr double separated_overlap = 2 * tolerance::accessible;

/// Returns whether areas have a kink because the SAS sphere of an exposed atom of a complete
/// cluster and another one just touch in an accessible point. `weights` are those of the areas.
bool has_tangent_spheres(const SurfaceModel& surface, const AreaWeights& weights,
                         const Patches& patches, ClusterIndex cluster);

}  // namespace eses::detail
