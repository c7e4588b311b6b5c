#pragma once
/// The division of a concave patch among three atoms, in closed form.

#include <array>
#include <optional>
#include <span>

#include "geometry/sphere_part.hpp"
#include "surface/concave_patch.hpp"

namespace eses::detail {

/// Returns the solid angles of the parts of a patch that belong to its three atoms, in the order of
/// `touched`. The cone of the patch is not flat. `arcs` bound the patch; they are not needed if it
/// has no cutters. Returns nothing if the patch has an unusual shape, or if rounding may decide how
/// its borders are connected. Then `part_of_atom` gives the parts.
std::optional<std::array<double, 3>> divide_among_three(const SurfaceModel& surface, Vec3 center,
                                                        const ConcavePatch& patch,
                                                        std::span<const RimArc> arcs);

}  // namespace eses::detail
