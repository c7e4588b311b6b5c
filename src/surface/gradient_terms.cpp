#include "surface/gradient_terms.hpp"

#include <algorithm>
#include <cmath>

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

// Derivatives of the areas of two spheres of radii `first` and `second` within the two faces.
CircleGradient face_gradient(const ArcShape& shape, const SasSphere& one, const SasSphere& two,
                             double first, double second) {
  const ContactCircle& circle = shape.circle;
  const double d = circle.first_height + circle.second_height, t = shape.swept.angle;
  const double w1 = squared(first), w2 = squared(second), R1 = one.radius, R2 = two.radius;
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
};

SaddleWidth saddle_width(const SaddleOutline& outline) {
  const double rho = outline.rho, p = outline.probe;
  SaddleWidth width;
  const auto add = [&](double low, double high) {
    if (low >= high) return;
    const double sine = std::sin(high) - std::sin(low), length = high - low;
    width.area += p * (rho * length - p * sine);
    width.by_rho += p * length;
    width.by_probe += rho * length - 2 * p * sine;
    if (high == outline.contact.high) width.by_high += p * (rho - p * std::cos(high));
    if (low == outline.contact.low) width.by_low -= p * (rho - p * std::cos(low));
  };
  if (outline.cusp == 0) {
    add(outline.contact.low, outline.contact.high);
  } else {  // at the cusp, the element of area is 0
    add(outline.contact.low, std::min(outline.contact.high, -outline.cusp));
    add(std::max(outline.contact.low, outline.cusp), outline.contact.high);
  }
  return width;
}

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

// Adds the derivatives of the area of the saddle of two atoms for an end of its arc that moves
// along the circle. Returns the derivative by the centre of the placement.
Vec3 add_arc_end(const SurfaceModel& surface, Vec3 center, const std::array<AtomIndex, 3>& atoms,
                 GradientTerms& terms) {
  const SasSphere first = surface.sas_sphere(atoms[0]), second = surface.sas_sphere(atoms[1]);
  const ContactCircle circle = make_contact_circle(first, second);
  if (circle.radius == 0) return {};
  const Vec3 along = cross(circle.axis, normalized(center - circle.center));
  // The arc leaves the third atom's sphere.
  const double side = dot(along, center - surface.atoms[atoms[2]].center) > 0 ? -1 : 1;
  const double area = saddle_width(make_outline(circle, surface.probe_radius)).area;
  const Vec3 by_center = (side * area / circle.radius) * along;
  const double share = circle.first_height / (circle.first_height + circle.second_height);
  terms.atoms.push_back({atoms[0], ses_area_quantity, (share - 1) * by_center, 0});
  terms.atoms.push_back({atoms[1], ses_area_quantity, -share * by_center, 0});
  return by_center;
}

}  // namespace

void add_arc_gradient(const SurfaceModel& surface, const ArcShape& shape,
                      const SaddleOutline& outline, const SurfaceIntegrals& saddle,
                      GradientTerms& terms) {
  const auto& [arc, circle, swept] = shape;
  const SasSphere one = surface.sas_sphere(arc.first), two = surface.sas_sphere(arc.second);
  face_gradient(shape, one, two, one.radius, two.radius)
      .add_to(terms, sas_area_quantity, arc, circle);

  CircleGradient area = face_gradient(shape, one, two, surface.atoms[arc.first].radius,
                                      surface.atoms[arc.second].radius);
  const double p = surface.probe_radius, rho = circle.radius;
  if (p >= 0) {
    const SaddleWidth width = saddle_width(outline);
    // The angles are -atan(h_1 / rho) and atan(h_2 / rho).
    const double by_first = -swept.angle * width.by_low / squared(one.radius);
    const double by_second = swept.angle * width.by_high / squared(two.radius);
    area.first_height = by_first * rho;
    area.second_height = by_second * rho;
    area.rho = swept.angle * width.by_rho - by_first * circle.first_height -
               by_second * circle.second_height;
    area.resolve(circle, one.radius, two.radius);
    terms.probe[ses_area_quantity] += swept.angle * width.by_probe;
  }
  area.add_to(terms, ses_area_quantity, arc, circle);
  if (p <= 0 || rho == 0) return;

  // The surface moves with the contact circle: by cos t (e . dm + d rho) - sin t (u . dm) +
  // rho sin t (e . du) - dp along its normal, with the circle's centre m and the radial vector e.
  const double along = dot(saddle.vector_area, circle.axis);
  CircleGradient volume;
  volume.axis =
      circle.first_height * saddle.vector_area - (rho * along / swept.angle) * swept.radial;
  volume.first_height = along;
  volume.rho = (saddle.flux + p * saddle.area) / rho;
  volume.resolve(circle, one.radius, two.radius);
  volume.add_to(terms, ses_volume_quantity, arc, circle);
  terms.atoms.push_back({arc.first, ses_volume_quantity, saddle.vector_area, 0});
  terms.probe[ses_volume_quantity] -= saddle.area;
}

void add_placement_gradient(const SurfaceModel& surface, const ConcavePatch& patch,
                            GradientTerms& terms) {
  const ProbePlacement& placement = patch.placement;
  const auto& [a, b, c] = placement.atoms;
  const Vec3 center = placement.center;
  const double p = surface.probe_radius;
  Vec3 by_center = add_arc_end(surface, center, {a, b, c}, terms) +
                   add_arc_end(surface, center, {b, c, a}, terms) +
                   add_arc_end(surface, center, {c, a, b}, terms);

  // `radial` is the integral of the direction n along the arc, across the axis of the cap.
  const auto add_plane = [&](std::size_t k, Vec3 radial) {
    const AtomIndex i = placement.atoms[k], j = placement.atoms[(k + 1) % 3];
    const Vec3 to_i = surface.atoms[i].center - center, to_j = surface.atoms[j].center - center;
    const Vec3 normal = cross(to_i, to_j), axis = patch.caps[k].axis;
    const double sign = dot(normal, axis) < 0 ? -1 : 1;
    const Vec3 across = radial - dot(radial, axis) * axis;
    const Vec3 by_normal = (-sign * p * p / norm(normal)) * across;
    const Vec3 by_i = cross(to_j, by_normal), by_j = cross(by_normal, to_i);
    terms.atoms.push_back({i, ses_area_quantity, by_i, 0});
    terms.atoms.push_back({j, ses_area_quantity, by_j, 0});
    by_center = by_center - by_i - by_j;
  };
  if (patch.cutters.empty()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 from = normalized(surface.atoms[placement.atoms[k]].center - center);
      const Vec3 to = normalized(surface.atoms[placement.atoms[(k + 1) % 3]].center - center);
      add_plane(k, cross(to - from, normalized(cross(from, to))));
    }
  } else {
    for (const RimArc& arc : patch.arcs) {
      const SphericalCap& cap = patch.caps[arc.cap];
      const Vec3 radial = cross(arc.end - arc.start, cap.axis);
      if (arc.cap < 3) {
        add_plane(arc.cap, radial);
        continue;
      }
      const double length = 2 * p * cap.cosine;
      const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
      const Vec3 by_cutter = (p * arc.angle / 2) * cap.axis - (p * p * sine / length) * radial;
      add_motion(surface, *patch.cutters[arc.cap - 3], ses_area_quantity, by_cutter, terms);
      by_center = by_center - by_cutter;
      terms.probe[ses_area_quantity] -= arc.angle * length / 2;
    }
  }
  add_motion(surface, placement, ses_area_quantity, by_center, terms);
  add_motion(surface, placement, ses_volume_quantity, -(p * p) * patch.part.vector_area, terms);
  terms.probe[ses_area_quantity] += 2 * p * patch.part.solid_angle;
  terms.probe[ses_volume_quantity] -= p * p * patch.part.solid_angle;
}

}  // namespace eses::detail
