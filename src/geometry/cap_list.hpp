#pragma once
/// Lists of spheres and caps as structures of arrays, padded for vector loops.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/contact_circle.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// A list of SAS spheres. The first `count` elements of each array are in use.
struct SphereList {
  std::vector<double> x, y, z, radius;
  std::size_t count = 0;

  void clear() { count = 0; }
  void push_back(const SasSphere& sphere) {
    if (count + 1 + vector_padding > x.size()) make_room(count + 1);
    set(count++, sphere);
  }
  /// Stores a sphere where there is room.
  void set(std::size_t k, const SasSphere& sphere) {
    x[k] = sphere.center.x;
    y[k] = sphere.center.y;
    z[k] = sphere.center.z;
    radius[k] = sphere.radius;
  }
  /// Makes room for `capacity` spheres. The values of new elements are unspecified.
  void make_room(std::size_t capacity);
};

/// A list of caps of one SAS sphere. The first `count` elements of each array are in use.
struct CapList {
  std::vector<double> x, y, z;  ///< components of the axes
  std::vector<double> height, blocking_height;
  std::size_t count = 0;

  std::size_t size() const { return count; }
  bool empty() const { return count == 0; }
  Cap operator[](std::size_t k) const {
    return {{x[k], y[k], z[k]}, height[k], blocking_height[k]};
  }

  void clear() { count = 0; }
  void push_back(const Cap& cap) {
    make_room(count + 1);
    set(count++, cap);
  }
  /// Stores a cap where there is room.
  void set(std::size_t k, const Cap& cap) {
    x[k] = cap.axis.x;
    y[k] = cap.axis.y;
    z[k] = cap.axis.z;
    height[k] = cap.height;
    blocking_height[k] = cap.blocking_height;
  }
  /// Makes room for `capacity` caps. The values of new elements are unspecified.
  void make_room(std::size_t capacity);
};

/// 0-based positions in a SphereList. The first `count` elements are in use. They are followed by
/// zeros as far as a vector loop may read.
struct SpherePositions {
  std::vector<std::int64_t> at;
  std::size_t count = 0;
};

/// Replaces `positions` by the ascending positions of the spheres whose ball is nearer to `box`
/// than `distance`.
void find_near_box(const Box& box, double distance, const SphereList& spheres,
                   SpherePositions& positions);

/// Replaces `chosen` by the spheres at `positions`.
void choose_spheres(const SphereList& spheres, const SpherePositions& positions,
                    SphereList& chosen);

/// Replaces `caps` by the caps that spheres cut from `sphere`, and `positions` by the positions of
/// these spheres. The first `count` elements of `near` are the positions of all spheres that meet
/// `sphere`, and perhaps of others; zeros follow as far as a vector loop may read. A sphere with
/// the same centre, and one that overlaps `sphere` by at most `min_overlap` (angstrom), does not
/// meet it. The values equal those of make_cap, bit for bit.
void make_caps(const SasSphere& sphere, const SphereList& spheres,
               const std::vector<std::int32_t>& near, std::size_t count, double min_overlap,
               SpherePositions& positions, CapList& caps);

}  // namespace eses::detail
