#pragma once
/// Lists of spheres and of caps in the layout of vector loops: an array for each component, with
/// room for whole vectors behind the last element.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// SAS spheres. The first `count` elements of each array are in use.
struct SphereList {
  std::vector<double> x, y, z, radius;
  std::size_t count = 0;

  void clear() { count = 0; }
  void push_back(const SasSphere& sphere);
  /// Makes room for `capacity` spheres. The new elements have no defined values.
  void make_room(std::size_t capacity);
};

/// Caps of one SAS sphere. The first `count` elements of each array are in use.
struct CapList {
  std::vector<double> x, y, z;  ///< axis
  std::vector<double> height, blocking_height;
  std::size_t count = 0;

  std::size_t size() const { return count; }
  bool empty() const { return count == 0; }
  Cap operator[](std::size_t k) const {
    return {{x[k], y[k], z[k]}, height[k], blocking_height[k]};
  }

  void clear() { count = 0; }
  void push_back(const Cap& cap);
  /// Makes room for `capacity` caps. The new elements have no defined values.
  void make_room(std::size_t capacity);
};

/// Positions in a SphereList. The first `count` elements are in use; behind them are zeros as far
/// as a vector loop may read.
struct SpherePositions {
  std::vector<std::int64_t> at;
  std::size_t count = 0;
};

/// Replaces `positions` by those of the spheres whose surface is less than `distance` from a point
/// of `box`, or inside of it, ascending.
void find_near_box(const Box& box, double distance, const SphereList& spheres,
                   SpherePositions& positions);

/// Replaces `chosen` by the spheres at `positions`.
void choose_spheres(const SphereList& spheres, const SpherePositions& positions,
                    SphereList& chosen);

/// Replaces `positions` by those of the spheres that meet `sphere`, ascending. Spheres that merely
/// touch it do not meet it, and neither does the sphere itself.
void find_meeting(const SasSphere& sphere, const SphereList& spheres, SpherePositions& positions);

/// Replaces `caps` by those that the spheres at `positions` cut from `sphere`. The values are those
/// of make_cap, bit for bit.
void make_caps(const SasSphere& sphere, const SphereList& spheres, const SpherePositions& positions,
               CapList& caps);

}  // namespace eses::detail
