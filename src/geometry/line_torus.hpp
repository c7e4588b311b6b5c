#pragma once
/// Where a line leaves the tube of a probe rolling around a contact circle.

#include <algorithm>
#include <array>

#include "eses/vec3.hpp"

namespace eses::detail {

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

namespace line_torus {

/// Newton's method squares the relative error: after a step this small the next would not move.
inline constexpr double last_step = 1e-9;
inline constexpr int max_iterations = 60;

/// A root that is to move by more than this was no root of the outer sheet.
inline constexpr double max_polish = 1e-5;

/// A point with |w|^2 + rho^2 - p^2 below this (square angstrom) lies on the inner sheet: rounding
/// near a cusp stays above. Small tubes need a smaller bound, as the sheets are p apart at most.
inline double inner_sheet(double tube_radius) {
  return -1e-6 * std::min(1.0, tube_radius * tube_radius);
}

}  // namespace line_torus
}  // namespace eses::detail
