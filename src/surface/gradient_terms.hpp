#pragma once
/// Derivatives of areas and volumes by the centres and SAS radii of atoms, and by the probe radius.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/patches.hpp"

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

/// The weights of the areas of all atoms.
class AreaWeights {
 public:
  /// Weights by atom index; all weights are 1 if they are empty.
  explicit AreaWeights(std::span<const double> weights) : weights_(weights) {}
  double operator[](AtomIndex atom) const { return weights_.empty() ? 1 : weights_[atom]; }

 private:
  std::span<const double> weights_;
};

/// Adds the derivatives for a placement that moves, with the derivative by its centre. The centre
/// keeps its distance from three atoms: (v - a) . (dv - da) = R dR.
void add_motion(const SurfaceModel& surface, const ProbePlacement& placement, Quantity quantity,
                Vec3 by_center, GradientTerms& terms);

/// Does the same for a probe that touches several atoms. Of all derivatives that move the probe
/// with the atoms if they all move together, adds the smallest ones.
void add_common_motion(const SurfaceModel& surface, Vec3 center, std::span<const AtomIndex> touched,
                       Quantity quantity, Vec3 by_center, GradientTerms& terms);

}  // namespace eses::detail
