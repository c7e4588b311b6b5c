#pragma once
/// Where a line leaves the tube of a probe rolling around a contact circle.

#include <array>

#include "eses/vec3.hpp"

namespace eses {

/// At most four parameters, ascending.
struct TubeExits {
  std::array<double, 4> parameters{};
  int count = 0;
};

/// The tube is { x : distance to the circle < tube_radius }; the line is start + t * step in a
/// frame whose origin is the circle's centre, with `axis` the circle's unit axis. Returns the t in
/// [low, high] at which the line passes from inside the tube to outside. A self-intersecting
/// (spindle) torus has only its outer sheet here, as the distance to the circle is that to its
/// nearest point.
TubeExits tube_exits(Vec3 start, Vec3 step, Vec3 axis, double circle_radius, double tube_radius,
                     double low, double high);

}  // namespace eses
