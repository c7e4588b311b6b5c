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
enum Quantity : std::uint8_t {
  sas_area_quantity,
  ses_area_quantity,
  ses_volume_quantity,
  weighted_sas_area_quantity,
  weighted_ses_area_quantity
};
inline constexpr std::size_t quantity_count = 5;

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

/// The weights of the areas of all atoms.
class AreaWeights {
 public:
  /// Weights by atom index; all weights are 1 if they are empty.
  explicit AreaWeights(std::span<const double> weights) : weights_(weights) {}
  double operator[](AtomIndex atom) const { return weights_.empty() ? 1 : weights_[atom]; }

 private:
  std::span<const double> weights_;
};

/// Adds the derivatives of the areas of the two faces at an arc, and of the area of its saddle for
/// ends that move with the circle.
void add_arc_area_gradient(const SurfaceModel& surface, const ArcShape& shape,
                           const SaddleOutline& outline, const AreaWeights& weights,
                           Quantity sas_quantity, Quantity ses_quantity, GradientTerms& terms);

/// Adds the derivatives of the volume of a saddle. `saddle` has the integrals over the patch.
void add_arc_volume_gradient(const SurfaceModel& surface, const ArcShape& shape,
                             const SurfaceIntegrals& saddle, GradientTerms& terms);

/// Adds the derivatives of the areas of the three saddles that end at a placement, which follow
/// from its motion.
void add_saddle_end_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                             const AreaWeights& weights, Quantity quantity, GradientTerms& terms);

/// The placements that touch three atoms into which a placement divides: itself, or those of
/// divide_cone. A placement that does not move has none.
using PlacementParts = std::span<const ProbePlacement>;

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

/// Adds the derivatives of the area of a part, times `weight`.
void add_concave_area_gradient(const SurfaceModel& surface, const ConcavePart& concave,
                               double weight, Quantity quantity, GradientTerms& terms);

/// Adds the derivatives of the volume at a concave patch.
void add_concave_volume_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                                 const SpherePart& part, GradientTerms& terms);

}  // namespace eses::detail
