#pragma once
/// Derivatives of the areas and volumes at a concave patch.

#include <span>
#include <vector>

#include "surface/concave_patch.hpp"
#include "surface/gradient_terms.hpp"

namespace eses::detail {

/// A part of the patch at a placement that touches three atoms.
struct ConcavePart {
  const ProbePlacement& placement;
  SpherePart part;
  std::span<const SphericalCap> caps;  ///< three bounding planes, then those of `cutters`, borders
  std::span<const RimArc> arcs;        ///< that bound the part
  std::span<const PlacementParts> cutters;
  PlacementParts parts;  ///< that arise together with `placement`, and the placement itself
  /// The atom of the part, if the patch is divided among its atoms. The border with atom
  /// `borders[k]` is the cap with the number 3 + cutters.size() + k.
  AtomIndex owner = 0;
  std::span<const AtomIndex> borders;
};

/// Finds where the bounding planes of a triangle meet those of its cutters, if both planes contain
/// the axis of two atoms: at the points of the probe's sphere on the axis. The planes of placements
/// close to each other are almost the same, and their common line has the errors of the placements
/// divided by their distance.
void find_meetings_on_axes(const SurfaceModel& surface, const ProbePlacement& placement,
                           std::span<const PlacementParts> cutters,
                           std::vector<KnownMeeting>& found);

/// Adds the derivatives of the area of a part, times `weight`.
void add_concave_area_gradient(const SurfaceModel& surface, const ConcavePart& concave,
                               double weight, Quantity quantity, GradientTerms& terms);

/// Adds the derivatives of the volume at a concave patch.
void add_concave_volume_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                                 const SpherePart& part, GradientTerms& terms);

}  // namespace eses::detail
