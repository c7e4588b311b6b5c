#pragma once
/// Intersections of a line with the outer sheet of a torus: the points at which the line leaves the
/// tube that a probe sweeps when it rolls around a contact circle.
///
/// Let w be a point relative to the circle's centre, z = w . axis its height above the circle's
/// plane, s its distance from the axis, rho the radius of the circle and p that of the tube. The
/// torus (s - rho)^2 + z^2 = p^2 reads A = 2 rho s with A = |w|^2 + rho^2 - p^2. Squaring gives the
/// quartic A^2 - 4 rho^2 s^2 = 0 along the line. It also has the roots of the inner sheet, where
/// A < 0.
///
/// The roots are isolated in the Bernstein basis: a polynomial has at most as many roots in an
/// interval as its Bernstein coefficients have sign changes (Farouki, Comput. Aided Geom. Des. 29,
/// 379, 2012, doi:10.1016/j.cagd.2012.03.001). doc/algorithm.md derives all steps.

#include <algorithm>
#include <array>

#include "eses/vec3.hpp"

namespace eses::detail {

/// The parameters of at most four exits, ascending.
struct TubeExits {
  std::array<double, 4> parameters{};
  int count = 0;
};

/// Returns the parameters t in [low, high] at which the line start + t * step leaves the tube
/// { x : distance to the circle < tube_radius }. Positions are relative to the circle's centre, and
/// `axis` is the unit axis of the circle. Only the outer sheet of a self-intersecting (spindle)
/// torus bounds the tube. Lengths are in angstrom.
TubeExits tube_exits(Vec3 start, Vec3 step, Vec3 axis, double circle_radius, double tube_radius,
                     double low, double high);

namespace line_torus {

/// Newton's method stops after a smaller step, relative to the interval. It converges
/// quadratically, so the next step would be below rounding.
inline constexpr double last_step = 1e-9;

/// Maximum number of iterations, enough for bisection to full precision.
inline constexpr int max_iterations = 60;

/// The final Newton step of a root of the outer sheet is smaller than this, relative to the
/// interval.
inline constexpr double max_polish = 1e-5;

/// Returns the bound for A = |w|^2 + rho^2 - p^2 (square angstrom) below which a root lies on the
/// inner sheet. Rounding near a cusp stays above it. Small tubes need a smaller bound, as their
/// sheets are at most p apart.
inline double inner_sheet(double tube_radius) {
  return -1e-6 * std::min(1.0, tube_radius * tube_radius);
}

}  // namespace line_torus
}  // namespace eses::detail
