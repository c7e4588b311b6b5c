#pragma once
/// Derivatives of areas and volumes by the centres and SAS radii of atoms, and by the probe radius.

#include <array>
#include <span>
#include <vector>

#include "geometry/sphere_part.hpp"
#include "surface/patches.hpp"
#include "surface/saddle.hpp"

namespace eses::detail {

/// The quantities with derivatives that depend on arcs and placements.
enum Quantity : std::uint8_t { sas_area_quantity, ses_area_quantity, ses_volume_quantity };
inline constexpr std::size_t quantity_count = 3;

/// The contribution of a patch to the derivatives by an atom.
struct GradientTerm {
  AtomIndex atom = 0;
  Quantity quantity = sas_area_quantity;
  Vec3 center;
  double sas_radius = 0;
};

/// Contributions of several patches.
struct GradientTerms {
  std::vector<GradientTerm> atoms;
  std::array<double, quantity_count> probe{};  ///< at constant SAS radii

  void clear() {
    atoms.clear();
    probe = {};
  }
};

/// An arc with its circle.
struct ArcShape {
  const Arc& arc;
  const ContactCircle& circle;
  const SweptArc& swept;
};

/// Adds the derivatives of the areas of the two faces at an arc, and of the area and volume of its
/// saddle for ends that move with the circle. `saddle` has the integrals over the patch.
void add_arc_gradient(const SurfaceModel& surface, const ArcShape& shape,
                      const SaddleOutline& outline, const SurfaceIntegrals& saddle,
                      GradientTerms& terms);

/// A patch at a placement that touches three atoms.
struct ConcavePatch {
  const ProbePlacement& placement;
  SpherePart part;
  std::span<const SphericalCap> caps;  ///< three bounding planes, then those of `cutters`
  std::span<const RimArc> arcs;        ///< that bound the part; unused if there are no cutters
  std::span<const ProbePlacement* const> cutters;
};

/// Adds the derivatives that follow from the motion of a placement: those of the three saddles that
/// end there, and of the concave patch.
void add_placement_gradient(const SurfaceModel& surface, const ConcavePatch& patch,
                            GradientTerms& terms);

}  // namespace eses::detail
