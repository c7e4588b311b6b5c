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

namespace line_torus {

/// Newton's method squares the relative error: after a step this small the next would not move.
inline constexpr double last_step = 1e-9;
inline constexpr int most_iterations = 60;

/// A root that is to move by more than this was no root of the outer sheet.
inline constexpr double largest_polish = 1e-5;

/// Of squared distances from the circle's axis (square angstrom): below it lies the inner sheet for
/// certain, as rounding near a cusp stays above.
inline constexpr double inner_sheet = -1e-6;

}  // namespace line_torus
}  // namespace eses
