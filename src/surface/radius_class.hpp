#pragma once
/// Classes of atoms with similar radii, which are searched separately.

#include <algorithm>
#include <cmath>

namespace eses::detail {

/// Returns the class of a radius. Class 0 has radii up to `first_limit`. The limit of each further
/// class is twice the limit of the previous one.
inline int radius_class(double radius, double first_limit) {
  constexpr double max_quotient = 1e300;  // ilogb needs a finite argument
  return radius <= first_limit ? 0 : 1 + std::ilogb(std::min(radius / first_limit, max_quotient));
}

}  // namespace eses::detail
