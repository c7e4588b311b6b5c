#include "surface/concave_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/tolerances.hpp"
#include "surface/cutters.hpp"
#include "surface/normal_cone.hpp"

namespace eses::detail {
namespace {

// Returns a bound of the distance of placements that cut or touch each other's patches.
double max_cutting_distance(const PlacementIndex& placements) {
  return 2 * (placements.surface().probe_radius + tolerance::touching);
}

}  // namespace

void set_triangle(const SurfaceModel& surface, const ProbePlacement& placement,
                  ConcavePatch& patch) {
  patch.touched.assign(placement.atoms.begin(), placement.atoms.end());
  std::array<Vec3, 3> toward;
  for (std::size_t q = 0; q < 3; ++q)
    toward[q] = normalized(surface.atoms[placement.atoms[q]].center - placement.center);
  patch.toward.assign(toward.begin(), toward.end());
  const auto& [a, b, c] = toward;
  const double sign = dot(a, cross(b, c)) < 0 ? 1 : -1;
  patch.caps.clear();
  patch.cutters.clear();
  patch.cone = patch.part = {};
  for (const Vec3 normal : {cross(a, b), cross(b, c), cross(c, a)}) {
    const double length = norm(normal);
    if (length == 0) return;
    patch.caps.push_back({(sign / length) * normal, 0});
  }
  patch.cone = patch.part = triangle_part(a, b, c);
}

void set_cone(const PlacementIndex& placements, std::uint32_t number, ConcaveScratch& scratch,
              ConcavePatch& patch) {
  patch.number = number;
  placements.find_node(number, scratch.node);
  if (scratch.node.size() == 1)
    return set_triangle(placements.surface(), *placements.placements()[number], patch);
  placements.find_touched(scratch.node, patch.touched, patch.toward);
  patch.cutters.clear();
  patch.cone = {};
  switch (bound_cone(patch.toward, patch.caps)) {
    case ConeShape::flat:
      break;
    case ConeShape::whole:
      patch.cone.solid_angle = 4 * std::numbers::pi;
      break;
    case ConeShape::solid:
      patch.cone = scratch.finder.find(patch.caps);
      break;
  }
  patch.part = patch.cone;
}

void find_near_large(const PlacementIndex& placements, const Box& box, NearPlacements& near) {
  find_near_box(box, max_cutting_distance(placements), placements.center_list(), near.numbers);
  choose_spheres(placements.center_list(), near.numbers, near.centers);
}

void find_near_small(const PlacementIndex& placements, const Box& box, NearPlacements& near) {
  find_near_box(box, max_cutting_distance(placements), near.centers, near.in_small);
  choose_spheres(near.centers, near.in_small, near.small_centers);
}

void cut_cone(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch) {
  find_cutters(placements, scratch, patch);
  patch.part = patch.cutters.empty() ? patch.cone : scratch.finder.find(patch.caps);
}

bool has_tangent_patch(const ConcavePatch& patch, double probe_radius) {
  const double slack = tolerance::touching / probe_radius;
  return std::any_of(patch.tangent.begin(), patch.tangent.end(), [&](Vec3 direction) {
    return std::none_of(patch.caps.begin(), patch.caps.end(), [&](const SphericalCap& cap) {
      return dot(direction, cap.axis) > cap.cosine + slack;
    });
  });
}

SpherePart part_of_atom(const SurfaceModel& surface, const ConcavePatch& patch, AtomIndex owner,
                        ConcaveScratch& scratch) {
  scratch.caps = patch.caps;
  scratch.borders.clear();
  for (const AtomIndex other : patch.touched) {
    if (other == owner) continue;
    const Vec3 toward = surface.atoms[other].center - surface.atoms[owner].center;
    const double length = norm(toward);
    scratch.borders.push_back(other);
    scratch.caps.push_back({(1 / length) * toward,
                            (surface.atoms[other].radius - surface.atoms[owner].radius) / length});
  }
  return scratch.finder.find(scratch.caps);
}

}  // namespace eses::detail
