#include "surface/gradient_terms.hpp"

namespace eses::detail {

void add_motion(const SurfaceModel& surface, const ProbePlacement& placement, Quantity quantity,
                Vec3 by_center, GradientTerms& terms) {
  std::array<Vec3, 3> from;
  for (std::size_t q = 0; q < 3; ++q)
    from[q] = placement.center - surface.atoms[placement.atoms[q]].center;
  const double volume = dot(from[0], cross(from[1], from[2]));
  if (volume == 0) return;
  for (std::size_t q = 0; q < 3; ++q) {
    const double factor = dot(by_center, cross(from[(q + 1) % 3], from[(q + 2) % 3])) / volume;
    terms.atoms.push_back({placement.atoms[q], quantity, factor * from[q],
                           factor * surface.sas_sphere(placement.atoms[q]).radius});
  }
}

}  // namespace eses::detail
