#include "surface/gradient_terms.hpp"

namespace eses::detail {

void add_motion(const SurfaceModel& surface, const ProbePlacement& placement, Quantity quantity,
                Vec3 by_center, GradientTerms& terms) {
  std::array<Vec3, 3> from;
  for (std::size_t q = 0; q < 3; ++q)
    from[q] = placement.center - surface.atoms[placement.atoms[q]].center;
  const double volume = dot(from[0], cross(from[1], from[2]));
  if (volume == 0) return;
  std::array<double, 3> factors{};
  // If the directions are almost in a plane, the factors are large, and lose digits as the volume
  // does. Another step for what is left of the sum keeps the sum of the forces.
  Vec3 rest = by_center;
  for (int step = 0; step < 2; ++step) {
    for (std::size_t q = 0; q < 3; ++q)
      factors[q] += dot(rest, cross(from[(q + 1) % 3], from[(q + 2) % 3])) / volume;
    rest = by_center - factors[0] * from[0] - factors[1] * from[1] - factors[2] * from[2];
  }
  for (std::size_t q = 0; q < 3; ++q)
    terms.atoms.push_back({placement.atoms[q], quantity, factors[q] * from[q],
                           factors[q] * surface.sas_sphere(placement.atoms[q]).radius});
}

// The derivatives by the centres are f_q (v - a_q), and their sum is the derivative g by the centre
// v. The smallest f_q are u . (v - a_q), where u solves sum_q (v - a_q) (v - a_q)^T u = g.
void add_common_motion(const SurfaceModel& surface, Vec3 center, std::span<const AtomIndex> touched,
                       Quantity quantity, Vec3 by_center, GradientTerms& terms) {
  std::array<Vec3, 3> rows;
  for (const AtomIndex i : touched) {
    const Vec3 from = center - surface.atoms[i].center;
    for (std::size_t axis = 0; axis < 3; ++axis) rows[axis] = rows[axis] + from[axis] * from;
  }
  const Vec3 x = cross(rows[1], rows[2]), y = cross(rows[2], rows[0]), z = cross(rows[0], rows[1]);
  const double determinant = dot(rows[0], x);
  if (determinant == 0) return;
  const Vec3 u = (1 / determinant) * (by_center[0] * x + by_center[1] * y + by_center[2] * z);
  for (const AtomIndex i : touched) {
    const Vec3 from = center - surface.atoms[i].center;
    const double factor = dot(u, from);
    terms.atoms.push_back({i, quantity, factor * from, factor * surface.sas_sphere(i).radius});
  }
}

}  // namespace eses::detail
