#pragma once
/// Derivatives of the areas and volumes at an accessible arc, and of the ends of its saddle.

#include <array>

#include "surface/arc_patch.hpp"
#include "surface/gradient_terms.hpp"

namespace eses::detail {

/// Adds the derivatives of the areas of the two faces at an arc, and of the area of its saddle for
/// ends that move with the circle.
void add_arc_area_gradient(const SurfaceModel& surface, const Arc& arc, const ArcPatch& patch,
                           const AreaWeights& weights, Quantity sas_quantity, Quantity ses_quantity,
                           GradientTerms& terms);

/// Adds the derivatives of the volume of the saddle of an arc.
void add_arc_volume_gradient(const SurfaceModel& surface, const Arc& arc, const ArcPatch& patch,
                             GradientTerms& terms);

/// Adds the derivatives of the areas of the three saddles that end at a placement, which follow
/// from its motion.
void add_saddle_end_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                             const AreaWeights& weights, Quantity quantity, GradientTerms& terms);

/// Adds the derivatives of an area, given for each radian of the arc of the first two atoms, for
/// the end of the arc at `center` that moves along the circle. Returns the derivative by the
/// centre.
Vec3 add_arc_end(const SurfaceModel& surface, const ContactCircle& circle, Vec3 center,
                 const std::array<AtomIndex, 3>& atoms, double area, Quantity quantity,
                 GradientTerms& terms);

}  // namespace eses::detail
