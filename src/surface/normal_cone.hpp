#pragma once
/// The normal cone of the accessible set at a probe placement.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/sphere_part.hpp"

namespace eses::detail {

/// The shape of the cone of the directions to all atoms that a probe touches.
enum class ConeShape {
  flat,   ///< the directions are in a plane, so the cone has no area
  solid,  ///< the cone is bounded by planes
  whole,  ///< the directions surround the probe, which is trapped, so the cone has all directions
};

/// Finds the half spaces that bound the cone of several unit vectors. Replaces `caps` by their
/// complements.
ConeShape bound_cone(std::span<const Vec3> toward, std::vector<SphericalCap>& caps);

/// Divides the cone of several unit vectors into triangles, each given by the indices of its
/// corners. All triangles have corner 0. This is the division that arises if the spheres at these
/// directions grow, each of them much more than all later ones. Returns nothing if the cone is flat
/// or whole.
std::vector<std::array<std::size_t, 3>> divide_cone(std::span<const Vec3> toward);

}  // namespace eses::detail
