#pragma once
/// Descriptions of the cavities and the pieces of a molecule.

#include <vector>

#include "eses/cavities.hpp"
#include "surface/components.hpp"
#include "surface/measure_settings.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Returns the indices of cavities in descending order of their voids, and in the order of their
/// first atoms if the voids are equal.
std::vector<std::size_t> order_by_void(const std::vector<Cavity>& cavities);

/// Replaces `cavities` and `pieces` by those of a surface, the largest first. `probe_radius` is the
/// nominal one of `settings`; that of `surface` may be slightly smaller.
void list_components(const SurfaceModel& surface, Vec3 origin, const MeasureSettings& settings,
                     const Components& components, std::vector<Cavity>& cavities,
                     std::vector<Piece>& pieces);

}  // namespace eses::detail
