#pragma once
/// The probe placements that cut the concave patch of another one.

#include "surface/concave_patch.hpp"

namespace eses::detail {

/// Finds the placements that cut the cone of a patch, among all accessible ones that are nearer
/// than twice the probe radius, and adds their caps. A point of the patch is at the direction n
/// from its placement v. The placement w cuts it off if it is nearer, n . (w - v) > |w - v|^2 / (2
/// p). Also finds the placements that touch the probe's sphere from outside.
void find_cutters(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch);

}  // namespace eses::detail
