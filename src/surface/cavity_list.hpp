#pragma once
/// Descriptions of the cavities and the pieces of a molecule.

#include <vector>

#include "eses/cavities.hpp"
#include "surface/components.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Replaces `cavities` and `pieces` by those of a surface, the largest first. `probe_radius` is the
/// nominal one; that of `surface` may be slightly smaller.
void list_components(const SurfaceModel& surface, Vec3 origin, double probe_radius, int threads,
                     const Components& components, std::vector<Cavity>& cavities,
                     std::vector<Piece>& pieces);

}  // namespace eses::detail
