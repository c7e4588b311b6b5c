#pragma once
/// Spheres in single precision. They only select, with twice the lanes of double precision: no
/// sphere within a distance is missed, and some hardly farther away may be found.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/cap_list.hpp"

namespace eses::detail {

/// Spheres of a SphereList. The first `count` elements of each array are in use.
struct FloatSpheres {
  std::vector<float> x, y, z, radius;  ///< centres relative to `origin`
  std::vector<std::int32_t> position;  ///< 0-based, in the SphereList
  std::size_t count = 0;
  Vec3 origin;
  double slack = 0;  ///< bound of the rounding errors of distances (angstrom)

  /// Replaces the spheres by all of a list. The centres of the boxes and spheres near which
  /// spheres will be selected lie in the box `around`.
  void assign(const SphereList& spheres, const Box& around);
  /// Makes room for `capacity` spheres. The values of new elements are unspecified.
  void make_room(std::size_t capacity);
};

/// Replaces `chosen` by the spheres whose ball is nearer to `box` than `distance`.
void choose_near_box(const Box& box, double distance, const FloatSpheres& spheres,
                     FloatSpheres& chosen);

/// Lists the positions of the spheres that meet `sphere`, and that of itself, and returns their
/// number. `positions` only grows. Zeros follow the list as far as a vector loop may read.
std::size_t find_near_sphere(const SasSphere& sphere, const FloatSpheres& spheres,
                             std::vector<std::int32_t>& positions);

}  // namespace eses::detail
