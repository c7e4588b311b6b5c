#include "surface/concave_gradient.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "surface/saddle_gradient.hpp"

namespace eses::detail {
namespace {

// Returns how many parts of a placement touch both atoms.
std::ptrdiff_t count_touching(PlacementParts parts, AtomIndex i, AtomIndex j) {
  return std::ranges::count_if(parts, [&](const ProbePlacement& part) {
    const auto touches = [&](AtomIndex atom) {
      return std::find(part.atoms.begin(), part.atoms.end(), atom) != part.atoms.end();
    };
    return touches(i) && touches(j);
  });
}

// Returns the directions from a probe that touches two atoms to the points of its sphere on their
// axis.
std::optional<std::array<Vec3, 2>> points_on_axis(const SurfaceModel& surface, Vec3 center,
                                                  AtomIndex i, AtomIndex j) {
  const ContactCircle circle =
      make_contact_circle(surface.sas_sphere(std::min(i, j)), surface.sas_sphere(std::max(i, j)));
  const double p = surface.probe_radius, squared = (p - circle.radius) * (p + circle.radius);
  if (squared <= 0) return std::nullopt;
  const Vec3 inward = circle.center - center, along = std::sqrt(squared) * circle.axis;
  return std::array{normalized(inward - along), normalized(inward + along)};
}

// Adds the derivatives of the area of a patch at an arc in the plane of the placement and its first
// two atoms, if another part of the placement is on the other side of the plane. When both parts
// move apart, a saddle arises between them. Beyond the axis of the atoms, it has a negative width:
// the patches overlap, and cut each other in the middle. Returns the derivative by the centre of
// the placement.
Vec3 add_overlap(const SurfaceModel& surface, Vec3 center, const std::array<AtomIndex, 3>& atoms,
                 const RimArc& arc, double weight, Quantity quantity, GradientTerms& terms) {
  const ContactCircle circle =
      make_contact_circle(surface.sas_sphere(atoms[0]), surface.sas_sphere(atoms[1]));
  const SaddleOutline outline = make_outline(circle, surface.probe_radius);
  if (outline.cusp.sine == 0 || circle.radius == 0) return {};
  const Vec3 inward = normalized(circle.center - center);
  const auto angle_of = [&](Vec3 n) { return std::atan2(dot(n, circle.axis), dot(n, inward)); };
  const auto [first, last] = std::minmax({angle_of(arc.start), angle_of(arc.end)});
  const double cusp = std::atan2(outline.cusp.sine, outline.cusp.cosine);
  const double low = std::max(first, -cusp), high = std::min(last, cusp);
  if (low >= high) return {};
  const double p = outline.probe;
  const double area = p * (outline.rho * (high - low) - p * (std::sin(high) - std::sin(low)));
  return add_arc_end(surface, circle, center, atoms, weight * area, quantity, terms);
}

// Calls `action(part, start, end, angle)` for the pieces of an arc at which a placement cuts the
// patch of another one. A point of the arc is at the direction n from the centre of the patch, and
// at the direction m = n - 2 (n . u) u from the placement, where u is the axis of the cap. It
// belongs to the part in whose triangle m is, which is the part that it is nearest to if the parts
// move apart.
template <class Action>
void divide_arc(const SurfaceModel& surface, const RimArc& arc, const SphericalCap& cap,
                PlacementParts parts, Action&& action) {
  constexpr double two_pi = 2 * std::numbers::pi;
  const double c = cap.cosine, s = std::sqrt((1 - c) * (1 + c));
  const Vec3 u = cap.axis, across = cross(u, arc.start);
  const auto radial_at = [&](double angle) {
    return std::cos(angle) * arc.start + std::sin(angle) * across;
  };
  std::vector<std::array<Vec3, 3>> normals;  // of the planes that bound each triangle, inwards
  std::vector<double> angles{0, arc.angle};  // where the arc meets these planes
  for (const ProbePlacement& part : parts) {
    std::array<Vec3, 3> toward;
    for (std::size_t q = 0; q < 3; ++q)
      toward[q] = surface.atoms[part.atoms[q]].center - part.center;
    const double sign = dot(toward[0], cross(toward[1], toward[2])) < 0 ? -1 : 1;
    std::array<Vec3, 3>& planes = normals.emplace_back();
    for (std::size_t q = 0; q < 3; ++q) {
      planes[q] = sign * normalized(cross(toward[q], toward[(q + 1) % 3]));
      const double x = dot(planes[q], arc.start), y = dot(planes[q], across);
      const double cosine = c * dot(planes[q], u) / (s * std::hypot(x, y));
      if (!(std::fabs(cosine) < 1)) continue;
      for (const double side : {-1, 1}) {
        const double angle = std::atan2(y, x) + side * std::acos(cosine);
        const double turned = angle - two_pi * std::floor(angle / two_pi);
        if (turned < arc.angle) angles.push_back(turned);
      }
    }
  }
  std::sort(angles.begin(), angles.end());
  for (std::size_t k = 0; k + 1 < angles.size(); ++k) {
    const Vec3 middle = s * radial_at((angles[k] + angles[k + 1]) / 2) - c * u;
    const auto depth = [&](const std::array<Vec3, 3>& planes) {
      return std::min({dot(planes[0], middle), dot(planes[1], middle), dot(planes[2], middle)});
    };
    const auto deepest =
        std::max_element(normals.begin(), normals.end(),
                         [&](const auto& a, const auto& b) { return depth(a) < depth(b); });
    action(parts[static_cast<std::size_t>(deepest - normals.begin())], radial_at(angles[k]),
           radial_at(angles[k + 1]), angles[k + 1] - angles[k]);
  }
}

// Adds the derivatives of the area of a part of a patch, arc by arc of its boundary.
class PartGradient {
 public:
  PartGradient(const SurfaceModel& surface, const ConcavePart& concave, double weight,
               Quantity quantity, GradientTerms& terms)
      : surface_(surface), concave_(concave), weight_(weight), quantity_(quantity), terms_(terms) {}

  // Adds the derivatives for an arc in the plane of the placement and two of its atoms.
  void add_plane(const RimArc& arc) {
    const ProbePlacement& placement = concave_.placement;
    const double p = surface_.probe_radius;
    const std::size_t k = arc.cap;
    const AtomIndex i = placement.atoms[k], j = placement.atoms[(k + 1) % 3];
    const Vec3 to_i = surface_.atoms[i].center - placement.center;
    const Vec3 to_j = surface_.atoms[j].center - placement.center;
    const Vec3 normal = cross(to_i, to_j), axis = concave_.caps[k].axis;
    const double sign = dot(normal, axis) < 0 ? -1 : 1;
    const Vec3 by_normal = (-sign * weight_ * p * p / norm(normal)) * across(arc, axis);
    const Vec3 by_i = cross(to_j, by_normal), by_j = cross(by_normal, to_i);
    terms_.atoms.push_back({i, quantity_, by_i, 0});
    terms_.atoms.push_back({j, quantity_, by_j, 0});
    by_center_ = by_center_ - by_i - by_j;
    if (count_touching(concave_.parts, i, j) > 1)  // another part is beyond the plane
      by_center_ =
          by_center_ + add_overlap(surface_, placement.center, {i, j, placement.atoms[(k + 2) % 3]},
                                   arc, weight_, quantity_, terms_);
  }

  // Adds the derivatives for an arc at which another placement cuts the patch. If the placements
  // move across the line between them, the patch of one of them loses the area that the other one
  // gains. With equal weights, the two terms cancel, and are left out: they are inversely
  // proportional to the distance of the placements.
  void add_cutter(PlacementParts cutter, const RimArc& arc) {
    const SphericalCap& cap = concave_.caps[arc.cap];
    const double p = surface_.probe_radius, length = 2 * p * cap.cosine;
    if (2 * p - length <= tolerance::touching) return;  // the patches just touch
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const auto by_cutter = [&](Vec3 start, Vec3 end, double angle) {
      const Vec3 along = (weight_ * p * angle / 2) * cap.axis;
      if (quantity_ == ses_area_quantity) return along;
      const Vec3 radial = cross(end - start, cap.axis);
      return along - (weight_ * p * p * sine / length) * radial;
    };
    const auto move = [&](const ProbePlacement& moving, Vec3 start, Vec3 end, double angle) {
      add_motion(surface_, moving, quantity_, by_cutter(start, end, angle), terms_);
    };
    if (cutter.size() == 1)
      move(cutter.front(), arc.start, arc.end, arc.angle);
    else if (!cutter.empty())
      divide_arc(surface_, arc, cap, cutter, move);
    by_center_ = by_center_ - by_cutter(arc.start, arc.end, arc.angle);
    terms_.probe[quantity_] -= weight_ * arc.angle * length / 2;
  }

  // Adds the derivatives for an arc on the border with another atom. The border does not depend on
  // the placement. Its axis is (a_2 - a_1) / d, and its cosine (R_2 - R_1) / d.
  void add_border(AtomIndex other, const RimArc& arc) {
    const SphericalCap& cap = concave_.caps[arc.cap];
    const double p = surface_.probe_radius;
    const double d = norm(surface_.atoms[other].center - surface_.atoms[concave_.owner].center);
    const double by_cosine = weight_ * p * p * arc.angle / d;
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const Vec3 by_other =
        (-by_cosine * cap.cosine) * cap.axis - (weight_ * p * p * sine / d) * across(arc, cap.axis);
    terms_.atoms.push_back({other, quantity_, by_other, by_cosine});
    terms_.atoms.push_back({concave_.owner, quantity_, -by_other, -by_cosine});
  }

  // Adds the derivatives by the motion of the placement.
  void finish() const {
    add_motion(surface_, concave_.placement, quantity_, by_center_, terms_);
    terms_.probe[quantity_] += 2 * weight_ * surface_.probe_radius * concave_.part.solid_angle;
  }

 private:
  // Returns the integral of the direction along an arc, across the axis of its cap.
  static Vec3 across(const RimArc& arc, Vec3 axis) {
    const Vec3 radial = cross(arc.end - arc.start, axis);
    return radial - dot(radial, axis) * axis;
  }

  const SurfaceModel& surface_;
  const ConcavePart& concave_;
  double weight_;
  Quantity quantity_;
  GradientTerms& terms_;
  Vec3 by_center_;
};

}  // namespace

void find_meetings_on_axes(const SurfaceModel& surface, const ProbePlacement& placement,
                           std::span<const PlacementParts> cutters,
                           std::vector<KnownMeeting>& found) {
  found.clear();
  for (std::uint32_t k = 0; k < 3; ++k) {
    const AtomIndex i = placement.atoms[k], j = placement.atoms[(k + 1) % 3];
    for (std::uint32_t l = 0; l < cutters.size(); ++l)
      if (count_touching(cutters[l], i, j) > 0)
        found.push_back({k, 3 + l, points_on_axis(surface, placement.center, i, j)});
  }
}

void add_concave_area_gradient(const SurfaceModel& surface, const ConcavePart& concave,
                               double weight, Quantity quantity, GradientTerms& terms) {
  PartGradient gradient(surface, concave, weight, quantity, terms);
  for (const RimArc& arc : concave.arcs) {
    if (arc.cap < 3) {
      gradient.add_plane(arc);
    } else if (arc.cap < 3 + concave.cutters.size()) {
      gradient.add_cutter(concave.cutters[arc.cap - 3], arc);
    } else {
      gradient.add_border(concave.borders[arc.cap - 3 - concave.cutters.size()], arc);
    }
  }
  gradient.finish();
}

void add_concave_volume_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                                 const SpherePart& part, GradientTerms& terms) {
  const double p = surface.probe_radius;
  add_motion(surface, placement, ses_volume_quantity, -(p * p) * part.vector_area, terms);
  terms.probe[ses_volume_quantity] -= p * p * part.solid_angle;
}

}  // namespace eses::detail
