#include "surface/gradient_terms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace eses::detail {
namespace {

double squared(double x) { return x * x; }

// Derivatives of a quantity by the shape of a contact circle: the distance of the two centres, the
// SAS radii, the unit vector between the centres, and quantities that depend on these.
struct CircleGradient {
  double distance = 0, first_radius = 0, second_radius = 0;
  Vec3 axis;
  double first_height = 0, second_height = 0, rho = 0;

  // Replaces the derivatives by heights and radius of the circle.
  void resolve(const ContactCircle& circle, double first, double second) {
    const double d = circle.first_height + circle.second_height;
    if (circle.radius > 0) {  // rho^2 = R^2 - h^2
      first_radius += rho * first / circle.radius;
      first_height -= rho * circle.first_height / circle.radius;
    }
    // h = (d^2 + R_1^2 - R_2^2) / (2 d)
    const double heights = (first_height - second_height) / d;
    distance += (first_height * circle.second_height + second_height * circle.first_height) / d;
    first_radius += heights * first;
    second_radius -= heights * second;
  }

  void add_to(GradientTerms& terms, Quantity quantity, const Arc& arc,
              const ContactCircle& circle) const {
    const double d = circle.first_height + circle.second_height;
    const Vec3 across = axis - dot(axis, circle.axis) * circle.axis;
    const Vec3 by_second = distance * circle.axis + (1 / d) * across;
    terms.atoms.push_back({arc.first, quantity, -by_second, first_radius});
    terms.atoms.push_back({arc.second, quantity, by_second, second_radius});
  }
};

// Derivatives of the solid angles of two faces, times `w1` and `w2`.
CircleGradient face_gradient(const ArcShape& shape, const SasSphere& one, const SasSphere& two,
                             double w1, double w2) {
  const ContactCircle& circle = shape.circle;
  const double d = circle.first_height + circle.second_height, t = shape.swept.angle;
  const double R1 = one.radius, R2 = two.radius;
  CircleGradient gradient;
  // The solid angle changes by t dc - (integral of n dt) . du for a cap n . u > c.
  gradient.distance = t / d * (w1 * circle.second_height / R1 + w2 * circle.first_height / R2);
  gradient.first_radius =
      t * (w1 * (1 / d - circle.first_height / squared(R1)) - w2 * R1 / (d * R2));
  gradient.second_radius =
      t * (w2 * (1 / d - circle.second_height / squared(R2)) - w1 * R2 / (d * R1));
  gradient.axis = (circle.radius * (w2 / R2 - w1 / R1)) * shape.swept.radial;
  return gradient;
}

// The area of a saddle for each radian of its arc, and its derivatives.
struct SaddleWidth {
  double area = 0;
  double by_rho = 0, by_low = 0, by_high = 0, by_probe = 0;

  // Adds those of a part, times `weight`.
  void add(const SaddleOutline& outline, const OutlineRange& range, double weight) {
    const double rho = outline.rho, p = outline.probe;
    outline.for_each_part(range, [&](const OutlineRange& part) {
      const auto& [low, high] = part;
      const double sine = high.sine - low.sine, length = part.length();
      area += weight * p * (rho * length - p * sine);
      by_rho += weight * p * length;
      by_probe += weight * (rho * length - 2 * p * sine);
      // At the cusp, the element of area is 0.
      if (high.sine == outline.contact.high.sine) by_high += weight * p * (rho - p * high.cosine);
      if (low.sine == outline.contact.low.sine) by_low -= weight * p * (rho - p * low.cosine);
    });
  }
};

// The weighted area of a saddle that is divided between its atoms.
struct DividedSaddle {
  SaddleWidth width;
  double by_sine = 0;  // derivative of its area for each radian by the sine of the border's angle
  double sine = 0;     // of the border's angle

  DividedSaddle(const SaddleOutline& outline, const SaddleBorder& border, double first_weight,
                double second_weight)
      : sine(border.sine) {
    if (first_weight == second_weight) {
      width.add(outline, outline.contact, first_weight);
      return;
    }
    width.add(outline, {outline.contact.low, border.point}, first_weight);
    width.add(outline, {border.point, outline.contact.high}, second_weight);
    const double cosine = border.point.cosine;
    if (std::fabs(border.point.sine) < outline.cusp.sine || cosine == 0) return;
    by_sine = (first_weight - second_weight) * outline.probe *
              (outline.rho - outline.probe * cosine) / cosine;
  }
};

// Adds the derivatives for a placement that moves, with the derivative by its centre. The centre
// keeps its distance from three atoms: (v - a) . (dv - da) = R dR.
void add_motion(const SurfaceModel& surface, const ProbePlacement& placement, Quantity quantity,
                Vec3 by_center, GradientTerms& terms) {
  std::array<Vec3, 3> from;
  for (std::size_t q = 0; q < 3; ++q)
    from[q] = placement.center - surface.atoms[placement.atoms[q]].center;
  const double volume = dot(from[0], cross(from[1], from[2]));
  if (volume == 0) return;
  for (std::size_t q = 0; q < 3; ++q) {
    const double factor = dot(by_center, cross(from[(q + 1) % 3], from[(q + 2) % 3])) / volume;
    terms.atoms.push_back({placement.atoms[q], quantity, factor * from[q],
                           factor * surface.sas_sphere(placement.atoms[q]).radius});
  }
}

// Adds the derivatives of an area, given for each radian of the arc of the first two atoms, for the
// end of the arc at `center` that moves along the circle. Returns the derivative by the centre.
Vec3 add_arc_end(const SurfaceModel& surface, const ContactCircle& circle, Vec3 center,
                 const std::array<AtomIndex, 3>& atoms, double area, Quantity quantity,
                 GradientTerms& terms) {
  const Vec3 along = cross(circle.axis, normalized(center - circle.center));
  // The arc leaves the third atom's sphere.
  const double side = dot(along, center - surface.atoms[atoms[2]].center) > 0 ? -1 : 1;
  const Vec3 by_center = (side * area / circle.radius) * along;
  const double share = circle.first_height / (circle.first_height + circle.second_height);
  terms.atoms.push_back({atoms[0], quantity, (share - 1) * by_center, 0});
  terms.atoms.push_back({atoms[1], quantity, -share * by_center, 0});
  return by_center;
}

// Adds the derivatives of the area of the saddle of two atoms for an end of its arc. Returns the
// derivative by the centre of the placement.
Vec3 add_saddle_end(const SurfaceModel& surface, Vec3 center, const std::array<AtomIndex, 3>& atoms,
                    const AreaWeights& weights, Quantity quantity, GradientTerms& terms) {
  const SasSphere first = surface.sas_sphere(atoms[0]), second = surface.sas_sphere(atoms[1]);
  const ContactCircle circle = make_contact_circle(first, second);
  if (circle.radius == 0) return {};
  const SaddleOutline outline = make_outline(circle, surface.probe_radius);
  const SaddleBorder border = find_border(outline, circle, first.radius, second.radius);
  const double area =
      DividedSaddle(outline, border, weights[atoms[0]], weights[atoms[1]]).width.area;
  return add_arc_end(surface, circle, center, atoms, area, quantity, terms);
}

// Returns whether several parts of a placement touch both atoms.
bool is_shared_edge(PlacementParts parts, AtomIndex i, AtomIndex j) {
  if (parts.size() == 1) return false;
  return std::count_if(parts.begin(), parts.end(), [&](const ProbePlacement& part) {
           const auto touches = [&](AtomIndex atom) {
             return std::find(part.atoms.begin(), part.atoms.end(), atom) != part.atoms.end();
           };
           return touches(i) && touches(j);
         }) > 1;
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

}  // namespace

void add_arc_area_gradient(const SurfaceModel& surface, const ArcShape& shape,
                           const SaddleOutline& outline, const AreaWeights& weights,
                           Quantity sas_quantity, Quantity ses_quantity, GradientTerms& terms) {
  const auto& [arc, circle, swept] = shape;
  const SasSphere one = surface.sas_sphere(arc.first), two = surface.sas_sphere(arc.second);
  const double first_weight = weights[arc.first], second_weight = weights[arc.second];
  face_gradient(shape, one, two, first_weight * squared(one.radius),
                second_weight * squared(two.radius))
      .add_to(terms, sas_quantity, arc, circle);

  CircleGradient area =
      face_gradient(shape, one, two, first_weight * squared(surface.atoms[arc.first].radius),
                    second_weight * squared(surface.atoms[arc.second].radius));
  const double rho = circle.radius;
  if (surface.probe_radius >= 0) {
    const SaddleBorder border = find_border(outline, circle, one.radius, two.radius);
    const DividedSaddle saddle(outline, border, first_weight, second_weight);
    // The angles are -atan(h_1 / rho) and atan(h_2 / rho).
    const double by_first = -swept.angle * saddle.width.by_low / squared(one.radius);
    const double by_second = swept.angle * saddle.width.by_high / squared(two.radius);
    area.first_height = by_first * rho;
    area.second_height = by_second * rho;
    area.rho = swept.angle * saddle.width.by_rho - by_first * circle.first_height -
               by_second * circle.second_height;
    area.resolve(circle, one.radius, two.radius);
    // The sine of the border's angle is (R_2 - R_1) / d.
    const double by_difference =
        swept.angle * saddle.by_sine / (circle.first_height + circle.second_height);
    area.second_radius += by_difference;
    area.first_radius -= by_difference;
    area.distance -= by_difference * saddle.sine;
    terms.probe[ses_quantity] += swept.angle * saddle.width.by_probe;
  }
  area.add_to(terms, ses_quantity, arc, circle);
}

void add_arc_volume_gradient(const SurfaceModel& surface, const ArcShape& shape,
                             const SurfaceIntegrals& saddle, GradientTerms& terms) {
  const auto& [arc, circle, swept] = shape;
  const double p = surface.probe_radius, rho = circle.radius;
  if (p <= 0 || rho == 0 || swept.angle == 0) return;
  // The surface moves with the contact circle: by cos t (e . dm + d rho) - sin t (u . dm) +
  // rho sin t (e . du) - dp along its normal, with the circle's centre m and the radial vector e.
  const double along = dot(saddle.vector_area, circle.axis);
  CircleGradient volume;
  volume.axis =
      circle.first_height * saddle.vector_area - (rho * along / swept.angle) * swept.radial;
  volume.first_height = along;
  volume.rho = (saddle.flux + p * saddle.area) / rho;
  volume.resolve(circle, surface.sas_sphere(arc.first).radius,
                 surface.sas_sphere(arc.second).radius);
  volume.add_to(terms, ses_volume_quantity, arc, circle);
  terms.atoms.push_back({arc.first, ses_volume_quantity, saddle.vector_area, 0});
  terms.probe[ses_volume_quantity] -= saddle.area;
}

void add_saddle_end_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                             const AreaWeights& weights, Quantity quantity, GradientTerms& terms) {
  const auto& [a, b, c] = placement.atoms;
  Vec3 by_center;
  for (const std::array<AtomIndex, 3>& atoms :
       {std::array<AtomIndex, 3>{a, b, c}, {b, c, a}, {c, a, b}})
    by_center =
        by_center + add_saddle_end(surface, placement.center, atoms, weights, quantity, terms);
  add_motion(surface, placement, quantity, by_center, terms);
}

void add_concave_area_gradient(const SurfaceModel& surface, const ConcavePart& concave,
                               double weight, Quantity quantity, GradientTerms& terms) {
  const ProbePlacement& placement = concave.placement;
  const Vec3 center = placement.center;
  const double p = surface.probe_radius;
  Vec3 by_center;
  // `radial` is the integral of the direction n along the arc, across the axis of the cap.
  const auto add_plane = [&](const RimArc& arc, Vec3 radial) {
    const std::size_t k = arc.cap;
    const AtomIndex i = placement.atoms[k], j = placement.atoms[(k + 1) % 3];
    const Vec3 to_i = surface.atoms[i].center - center, to_j = surface.atoms[j].center - center;
    const Vec3 normal = cross(to_i, to_j), axis = concave.caps[k].axis;
    const double sign = dot(normal, axis) < 0 ? -1 : 1;
    const Vec3 across = radial - dot(radial, axis) * axis;
    const Vec3 by_normal = (-sign * weight * p * p / norm(normal)) * across;
    const Vec3 by_i = cross(to_j, by_normal), by_j = cross(by_normal, to_i);
    terms.atoms.push_back({i, quantity, by_i, 0});
    terms.atoms.push_back({j, quantity, by_j, 0});
    by_center = by_center - by_i - by_j;
    if (is_shared_edge(concave.parts, i, j))
      by_center = by_center + add_overlap(surface, center, {i, j, placement.atoms[(k + 2) % 3]},
                                          arc, weight, quantity, terms);
  };
  const auto add_cutter = [&](PlacementParts cutter, const SphericalCap& cap, const RimArc& arc) {
    const double length = 2 * p * cap.cosine;
    if (2 * p - length <= tolerance::touching) return;  // the patches just touch
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const auto by_cutter = [&](Vec3 start, Vec3 end, double angle) {
      const Vec3 radial = cross(end - start, cap.axis);
      return (weight * p * angle / 2) * cap.axis - (weight * p * p * sine / length) * radial;
    };
    const auto move = [&](const ProbePlacement& moving, Vec3 start, Vec3 end, double angle) {
      add_motion(surface, moving, quantity, by_cutter(start, end, angle), terms);
    };
    if (cutter.size() == 1)
      move(cutter.front(), arc.start, arc.end, arc.angle);
    else if (!cutter.empty())
      divide_arc(surface, arc, cap, cutter, move);
    by_center = by_center - by_cutter(arc.start, arc.end, arc.angle);
    terms.probe[quantity] -= weight * arc.angle * length / 2;
  };
  // The border does not depend on the placement. Its axis is (a_2 - a_1) / d, and its cosine
  // (R_2 - R_1) / d.
  const auto add_border = [&](AtomIndex other, const SphericalCap& cap, double angle, Vec3 radial) {
    const double d = norm(surface.atoms[other].center - surface.atoms[concave.owner].center);
    const double by_cosine = weight * p * p * angle / d;
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const Vec3 across = radial - dot(radial, cap.axis) * cap.axis;
    const Vec3 by_other =
        (-by_cosine * cap.cosine) * cap.axis - (weight * p * p * sine / d) * across;
    terms.atoms.push_back({other, quantity, by_other, by_cosine});
    terms.atoms.push_back({concave.owner, quantity, -by_other, -by_cosine});
  };
  for (const RimArc& arc : concave.arcs) {
    const SphericalCap& cap = concave.caps[arc.cap];
    const Vec3 radial = cross(arc.end - arc.start, cap.axis);
    if (arc.cap < 3) {
      add_plane(arc, radial);
    } else if (arc.cap < 3 + concave.cutters.size()) {
      add_cutter(concave.cutters[arc.cap - 3], cap, arc);
    } else {
      add_border(concave.borders[arc.cap - 3 - concave.cutters.size()], cap, arc.angle, radial);
    }
  }
  add_motion(surface, placement, quantity, by_center, terms);
  terms.probe[quantity] += 2 * weight * p * concave.part.solid_angle;
}

void add_concave_volume_gradient(const SurfaceModel& surface, const ProbePlacement& placement,
                                 const SpherePart& part, GradientTerms& terms) {
  const double p = surface.probe_radius;
  add_motion(surface, placement, ses_volume_quantity, -(p * p) * part.vector_area, terms);
  terms.probe[ses_volume_quantity] -= p * p * part.solid_angle;
}

}  // namespace eses::detail
