#include "surface/concave_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "geometry/tolerances.hpp"
#include "surface/cutters.hpp"
#include "surface/normal_cone.hpp"

namespace eses::detail {
namespace {

// Returns a bound of the distance of placements that cut or touch each other's patches.
double max_cutting_distance(const PlacementIndex& placements) {
  return 2 * (placements.surface().probe_radius + tolerance::touching);
}

// If the probe touches more atoms than this, the nearest ones bound the part of an atom first.
constexpr std::size_t max_borders = 32;

// Slack of the test whether a border can bound the part of an atom, far above the angles by which
// a probe fails to touch its atoms (radians).
constexpr double border_slack = 1e-5;

void add_border(const SurfaceModel& surface, AtomIndex owner, AtomIndex other,
                ConcaveScratch& scratch) {
  const Vec3 toward = surface.atoms[other].center - surface.atoms[owner].center;
  const double length = norm(toward);
  scratch.borders.push_back(other);
  scratch.caps.push_back({(1 / length) * toward,
                          (surface.atoms[other].radius - surface.atoms[owner].radius) / length});
}

// Returns a bound of the angle between a direction and the points of a part outside of caps.
double max_angle_from(Vec3 direction, std::span<const SphericalCap> caps,
                      std::span<const RimArc> arcs) {
  const bool has_opposite = std::none_of(caps.begin(), caps.end(), [&](const SphericalCap& cap) {
    return -dot(direction, cap.axis) > cap.cosine;
  });
  if (has_opposite) return std::numbers::pi;
  double largest = 0;
  for (const RimArc& arc : arcs) {
    const SphericalCap& cap = caps[arc.cap];
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    for (const Vec3 radial : {arc.start, arc.end}) {
      const double cosine = dot(direction, cap.cosine * cap.axis + sine * radial);
      largest = std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)) + arc.angle * sine / 2);
    }
  }
  return std::min(largest, std::numbers::pi);
}

// Does the same as part_of_atom. With the SAS radius R of an atom and the angle t from its
// direction, a point belongs to the atom with the smallest R (1 - cos t). So an atom in the
// direction at the angle b from the owner has no point of a part within the angle a, unless
// R_min (1 - cos(b - a)) < R (1 - cos a).
SpherePart part_among_many(const SurfaceModel& surface, const ConcavePatch& patch, AtomIndex owner,
                           ConcaveScratch& scratch) {
  const auto number = std::find(patch.touched.begin(), patch.touched.end(), owner);
  const Vec3 direction = patch.toward[static_cast<std::size_t>(number - patch.touched.begin())];
  double min_radius = surface.sas_sphere(owner).radius;
  std::vector<std::pair<double, AtomIndex>> others;  // by the angle from the owner
  for (std::size_t k = 0; k < patch.touched.size(); ++k) {
    min_radius = std::min(min_radius, surface.sas_sphere(patch.touched[k]).radius);
    if (patch.touched[k] == owner) continue;
    const double chord = std::min(norm(patch.toward[k] - direction), 2.0);
    others.emplace_back(2 * std::asin(chord / 2), patch.touched[k]);
  }
  std::sort(others.begin(), others.end());
  const double ratio = surface.sas_sphere(owner).radius / min_radius;
  for (std::size_t used = 0, next = max_borders / 2;;) {
    for (; used < next; ++used) add_border(surface, owner, others[used].second, scratch);
    const SpherePart part = scratch.finder.find(scratch.caps);
    const double largest = max_angle_from(direction, scratch.caps, scratch.finder.arcs());
    const double reach =
        largest + border_slack + std::acos(std::max(-1.0, 1 - ratio * (1 - std::cos(largest))));
    while (next < others.size() && others[next].first <= reach) ++next;
    if (next == used) return part;
  }
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

// Three spheres whose radii have the error e meet in a point with the error e / D, where D is the
// volume of the unit vectors from the point to their centres.
double ConcavePatch::rounding(double same_placement, double probe_radius) const {
  if (toward.size() != 3)
    return static_cast<double>(toward.size()) * same_placement / std::max(probe_radius, 0.1);
  constexpr double factor = 8 * std::numeric_limits<double>::epsilon();
  return factor / std::max(std::fabs(dot(toward[0], cross(toward[1], toward[2]))), factor);
}

void set_cone(const PlacementIndex& placements, PlacementNumber number, ConcaveScratch& scratch,
              ConcavePatch& patch) {
  patch.number = number;
  placements.find_node(number, scratch.node);
  if (scratch.node.size() == 1)
    return set_triangle(placements.surface(), placements.placement(number), patch);
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
  near.large.assign(near.centers, grown(box, max_cutting_distance(placements)));
}

void find_near_small(const PlacementIndex& placements, const Box& box, NearPlacements& near) {
  choose_near_box(box, max_cutting_distance(placements), near.large, near.small);
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
                        ConcaveScratch& scratch, std::span<const KnownMeeting> known) {
  scratch.caps = patch.caps;
  scratch.borders.clear();
  if (patch.touched.size() > max_borders) return part_among_many(surface, patch, owner, scratch);
  for (const AtomIndex other : patch.touched)
    if (other != owner) add_border(surface, owner, other, scratch);
  return scratch.finder.find(scratch.caps, known);
}

}  // namespace eses::detail
