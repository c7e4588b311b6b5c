#include "geometry/patch_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/arc_sector.hpp"

namespace eses::detail {

Box cap_box(Vec3 center, double radius, Vec3 pole, double cosine) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  Box box{center, center};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = pole[axis];
    const double across = std::sqrt(std::max(0.0, (1 - along) * (1 + along)));
    // The cap reaches the pole of the axis, or its rim's extreme.
    const double high = along >= cosine ? 1.0 : along * cosine + across * sine;
    const double low = -along >= cosine ? -1.0 : along * cosine - across * sine;
    box.high[axis] += radius * high;
    box.low[axis] += radius * low;
  }
  return box;
}

// That of the cap around the corners' mean that holds them, unless it is too wide to bound
// anything.
Box concave_box(Vec3 center, double radius, const std::array<Vec3, 3>& corners) {
  const Vec3 mean = normalized(corners[0] + corners[1] + corners[2]);
  const double cosine =
      std::min({dot(mean, corners[0]), dot(mean, corners[1]), dot(mean, corners[2])});
  return cosine < 0.1 ? ball_box(center, radius) : cap_box(center, radius, mean, cosine);
}

// The saddle is swept by the probe's outline between the points where it touches the two atoms. In
// the half plane through the axis, with the probe at distance rho from it, the outline's height
// rises from one point to the other, and it comes as near to the axis as rho - probe if these lie
// on both sides of the probe, but not beyond the axis.
Box saddle_box(const ContactCircle& circle, const Box& directions,
               const std::array<double, 2>& atom_radii, double probe_radius) {
  const double first_share = probe_radius / (atom_radii[0] + probe_radius);
  const double second_share = probe_radius / (atom_radii[1] + probe_radius);
  const double low = -first_share * circle.first_height;
  const double high = second_share * circle.second_height;
  const double first_radius = circle.radius * (1 - first_share);
  const double second_radius = circle.radius * (1 - second_share);
  const double min_radius = low < 0 && high > 0 ? std::max(0.0, circle.radius - probe_radius)
                                                : std::min(first_radius, second_radius);
  const Vec3 first_center = circle.center + low * circle.axis;
  const Vec3 second_center = circle.center + high * circle.axis;
  Box box = arc_box(first_center, first_radius, directions);
  include_arc(box, second_center, second_radius, directions);
  include_arc(box, first_center, min_radius, directions);
  include_arc(box, second_center, min_radius, directions);
  return box;
}

}  // namespace eses::detail
