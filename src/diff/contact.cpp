#include "diff/contact.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {

void ContactSpheres::add_convex(const Crossing& crossing) {
  // Welford's update (Technometrics 4, 419, 1962, doi:10.1080/00401706.1962.10490022) avoids
  // differences of large sums.
  Fit& fit = fits_[crossing.atoms[0]];
  const double weight = 1 / static_cast<double>(++fit.count);
  const Vec3 normal_step = crossing.normal - fit.normal;
  fit.normal = fit.normal + weight * normal_step;
  fit.position = fit.position + weight * (crossing.position - fit.position);
  fit.dn_dx_sum += dot(normal_step, crossing.position - fit.position);
  fit.dn_dn_sum += dot(normal_step, crossing.normal - fit.normal);
}

std::optional<Atom> ContactSpheres::sphere(AtomIndex atom) const {
  const auto found = fits_.find(atom);
  if (found == fits_.end() || found->second.dn_dn_sum <= 0) return std::nullopt;
  const Fit& fit = found->second;
  const double radius = fit.dn_dx_sum / fit.dn_dn_sum;
  return Atom{fit.position - radius * fit.normal, radius};
}

bool touches_all(const Crossing& crossing, std::span<const Atom> spheres, double tolerance) {
  // |v + p n|^2 = (r + p)^2 with v = position - centre and |n| = 1: |v|^2 - r^2 = 2 p (r - n.v).
  double product = 0, square = 0;
  for (const Atom& sphere : spheres) {
    const Vec3 v = crossing.position - sphere.center;
    const double slope = 2 * (sphere.radius - dot(crossing.normal, v));
    product += slope * (squared_norm(v) - sphere.radius * sphere.radius);
    square += slope * slope;
  }
  const double probe_radius = product / square;
  const Vec3 probe_center = crossing.position + probe_radius * crossing.normal;
  return std::all_of(spheres.begin(), spheres.end(), [&](const Atom& sphere) {
    const double gap = norm(probe_center - sphere.center) - sphere.radius - probe_radius;
    return std::fabs(gap) <= tolerance;  // false for NaN
  });
}

}  // namespace eses::detail
