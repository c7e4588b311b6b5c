#include "surface/normal_cone.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace eses::detail {
namespace {

// A direction is in a plane if its angle to the plane is at most this. The probe touches the atoms
// within tolerance::touching, so their directions are known to about 1e-7.
constexpr double in_plane = 2e-7;

// If there are more directions than this, those that bound the cone are chosen first.
constexpr std::size_t max_unchosen = 32;

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

// Does the same as bound_cone in a time proportional to the cube of the number of directions.
ConeShape bound_directly(std::span<const Vec3> toward, std::vector<SphericalCap>& caps) {
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

// The numbers of directions that span the same cone as all of them.
struct Spanning {
  ConeShape shape = ConeShape::flat;
  std::vector<std::size_t> chosen;  // ascending
};

// Begins with six of the directions and adds those that are farthest outside of the cone, until all
// are in it. Replaces `caps` like bound_cone.
Spanning choose_spanning(std::span<const Vec3> toward, std::vector<SphericalCap>& caps) {
  Spanning spanning;
  std::vector<std::size_t>& chosen = spanning.chosen;
  const auto choose_farthest = [&](Vec3 axis, double min_height) {
    std::size_t farthest = 0;
    for (std::size_t k = 1; k < toward.size(); ++k)
      if (dot(axis, toward[k]) > dot(axis, toward[farthest])) farthest = k;
    if (dot(axis, toward[farthest]) > min_height) chosen.push_back(farthest);
  };
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    for (const double sign : {-1, 1}) choose_farthest(sign * axis, -1);
  std::vector<Vec3> directions;
  for (std::size_t count = 0;;) {
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    directions.clear();
    for (const std::size_t k : chosen) directions.push_back(toward[k]);
    spanning.shape = bound_directly(directions, caps);
    if (spanning.shape != ConeShape::solid || chosen.size() == count) return spanning;
    count = chosen.size();
    for (const SphericalCap& cap : caps) choose_farthest(cap.axis, in_plane);
  }
}

// Returns the pairs of directions other than the first that may be an edge of the cone.
std::vector<std::pair<std::size_t, std::size_t>> possible_edges(std::span<const Vec3> toward) {
  std::vector<std::size_t> corners(toward.size());
  std::iota(corners.begin(), corners.end(), std::size_t{0});
  std::vector<SphericalCap> caps;
  if (toward.size() > max_unchosen) corners = choose_spanning(toward, caps).chosen;
  std::erase(corners, std::size_t{0});
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  for (std::size_t k = 0; k < corners.size(); ++k)
    for (std::size_t l = k + 1; l < corners.size(); ++l) edges.emplace_back(corners[k], corners[l]);
  return edges;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> divide_cone(std::span<const Vec3> toward) {
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<std::size_t> between;
  for (const auto& [a, b] : possible_edges(toward)) {
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
  if (toward.size() > max_unchosen) {
    const ConeShape shape = choose_spanning(toward, caps).shape;
    if (shape != ConeShape::flat) return shape;
  }
  return bound_directly(toward, caps);
}

}  // namespace eses::detail
