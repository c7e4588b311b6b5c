#include "geometry/patch_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/arc_sector.hpp"

namespace eses::detail {
namespace {

// Returns the box relative to a point, with slack and the rounding errors of single precision.
FloatBox to_floats(const Box& box, Vec3 point) {
  constexpr double max_error = 0x1p-23;  // relative
  FloatBox floats;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = box.low[axis] - point[axis], high = box.high[axis] - point[axis];
    floats.low[axis] = static_cast<float>(low - box_slack - max_error * std::fabs(low));
    floats.high[axis] = static_cast<float>(high + box_slack + max_error * std::fabs(high));
  }
  return floats;
}

}  // namespace

Box cap_box(Vec3 center, double radius, Vec3 pole, double cosine) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  Box box{center, center};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = pole[axis];
    const double across = std::sqrt(std::max(0.0, (1 - along) * (1 + along)));
    // The extreme point is the sphere's pole along the axis if the cap contains it, else it is on
    // the cap's rim.
    const double high = along >= cosine ? 1.0 : along * cosine + across * sine;
    const double low = -along >= cosine ? -1.0 : along * cosine - across * sine;
    box.high[axis] += radius * high;
    box.low[axis] += radius * low;
  }
  return box;
}

// Uses the box of the smallest cap around the mean of the corners that contains them. If that cap
// is almost a hemisphere, its box is hardly smaller than that of the whole sphere.
Box concave_box(Vec3 center, double radius, const std::array<Vec3, 3>& corners) {
  const Vec3 mean = normalized(corners[0] + corners[1] + corners[2]);
  const double cosine =
      std::min({dot(mean, corners[0]), dot(mean, corners[1]), dot(mean, corners[2])});
  return cosine < 0.1 ? ball_box(center, radius) : cap_box(center, radius, mean, cosine);
}

// The saddle patch is swept by the arc of the probe's outline between its points of contact with
// the two atoms. Consider the half plane that contains the axis and the probe's centre at the
// distance rho from the axis. Along the arc, the height rises from one point of contact to the
// other. The minimum distance from the axis is rho - probe, but not negative, if the points of
// contact are on different sides of the circle's plane; otherwise it is reached at a point of
// contact.
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

ArcBoxes arc_boxes(Vec3 first_center, const ContactCircle& circle, const Box& directions,
                   const std::array<double, 2>& atom_radii, double probe_radius) {
  Box box = saddle_box(circle, directions, atom_radii, probe_radius);
  ArcBoxes boxes;
  boxes.surface = to_floats(box, first_center);
  include_arc(box, circle.center, circle.radius, directions);
  boxes.solid = to_floats(box, first_center);
  return boxes;
}

}  // namespace eses::detail
