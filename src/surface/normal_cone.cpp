#include "surface/normal_cone.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// A direction is in a plane if its angle to the plane is at most this. The probe touches the atoms
// within tolerance::touching, so their directions are known to about 1e-7.
constexpr double in_plane = 2e-7;

// Sides of a plane on which there are directions.
struct Sides {
  bool has_positive = false, has_negative = false;
};

Sides sides_of(Vec3 normal, std::span<const Vec3> toward) {
  Sides sides;
  for (const Vec3 direction : toward) {
    const double height = dot(normal, direction);
    sides.has_positive = sides.has_positive || height > in_plane;
    sides.has_negative = sides.has_negative || height < -in_plane;
  }
  return sides;
}

// Appends the triangles of corner 0 and an edge of the cone. `between` are directions on the edge.
// The first of them is a corner if it comes before both ends.
void append_triangles(std::span<const Vec3> toward, std::size_t from, std::size_t to,
                      std::span<const std::size_t> between,
                      std::vector<std::array<std::size_t, 3>>& triangles) {
  if (between.empty() || between.front() > std::min(from, to)) {
    triangles.push_back({0, from, to});
    return;
  }
  const std::size_t middle = between.front();
  const auto lies_before_middle = [&](std::size_t k) {
    return dot(toward[from], toward[k]) > dot(toward[from], toward[middle]);
  };
  std::vector<std::size_t> before, after;
  for (const std::size_t k : between.subspan(1))
    (lies_before_middle(k) ? before : after).push_back(k);
  append_triangles(toward, from, middle, before, triangles);
  append_triangles(toward, middle, to, after, triangles);
}

}  // namespace

std::vector<std::array<std::size_t, 3>> divide_cone(std::span<const Vec3> toward) {
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<std::size_t> between;
  for (std::size_t a = 1; a < toward.size(); ++a)
    for (std::size_t b = a + 1; b < toward.size(); ++b) {
      const Vec3 normal = cross(toward[a], toward[b]);
      const double length = norm(normal);
      if (length <= in_plane) continue;
      const Vec3 unit = (1 / length) * normal;
      const Sides sides = sides_of(unit, toward);
      const bool is_edge = sides.has_positive != sides.has_negative;
      if (!is_edge || std::fabs(dot(unit, toward[0])) <= in_plane) continue;
      between.clear();
      bool is_complete = true;
      for (std::size_t k = 0; k < toward.size(); ++k) {
        if (k == a || k == b || std::fabs(dot(unit, toward[k])) > in_plane) continue;
        const bool is_between = dot(unit, cross(toward[a], toward[k])) >= 0 &&
                                dot(unit, cross(toward[k], toward[b])) >= 0;
        is_complete = is_complete && is_between;
        between.push_back(k);
      }
      if (is_complete) append_triangles(toward, a, b, between, triangles);
    }
  return triangles;
}

ConeShape bound_cone(std::span<const Vec3> toward, std::vector<SphericalCap>& caps) {
  caps.clear();
  bool is_flat = true;
  for (std::size_t a = 0; a < toward.size(); ++a)
    for (std::size_t b = a + 1; b < toward.size(); ++b) {
      const Vec3 normal = cross(toward[a], toward[b]);
      const double length = norm(normal);
      if (length <= in_plane) continue;  // equal or opposite directions
      const Vec3 unit = (1 / length) * normal;
      const Sides sides = sides_of(unit, toward);
      if (!sides.has_positive && !sides.has_negative) return ConeShape::flat;
      is_flat = false;
      if (sides.has_positive && sides.has_negative) continue;
      caps.push_back({sides.has_positive ? -unit : unit, 0});
    }
  if (is_flat) return ConeShape::flat;
  return caps.empty() ? ConeShape::whole : ConeShape::solid;
}

}  // namespace eses::detail
