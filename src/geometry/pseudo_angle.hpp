#pragma once
/// Pseudo-angles: lengths along the diamond |x| + |y| = 1, in [0, 4). They increase with the true
/// angle, and no trigonometric function is needed.

#include <cmath>

namespace eses::detail {

/// Pseudo-angles of a whole turn and of half a turn.
inline constexpr double full_diamond = 4, half_diamond = 2;

/// Returns the pseudo-angle of a vector; 0 for the null vector.
inline double diamond_angle(double x, double y) {
  const double r = std::fabs(x) + std::fabs(y);
  if (r == 0) return 0;
  return y >= 0 ? (x >= 0 ? y / r : 1 - x / r) : (x < 0 ? 2 - y / r : 3 + x / r);
}

}  // namespace eses::detail
