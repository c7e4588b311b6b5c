#include "surface/saddle_gradient.hpp"

#include <cmath>
#include <tuple>

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
CircleGradient face_gradient(const ArcPatch& patch, double w1, double w2) {
  const ContactCircle& circle = patch.circle;
  const double d = circle.first_height + circle.second_height, t = patch.swept.angle;
  const double R1 = patch.first.radius, R2 = patch.second.radius;
  CircleGradient gradient;
  // The solid angle changes by t dc - (integral of n dt) . du for a cap n . u > c.
  gradient.distance = t / d * (w1 * circle.second_height / R1 + w2 * circle.first_height / R2);
  gradient.first_radius =
      t * (w1 * (1 / d - circle.first_height / squared(R1)) - w2 * R1 / (d * R2));
  gradient.second_radius =
      t * (w2 * (1 / d - circle.second_height / squared(R2)) - w1 * R2 / (d * R1));
  gradient.axis = (circle.radius * (w2 / R2 - w1 / R1)) * patch.swept.radial;
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

}  // namespace

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

void add_arc_area_gradient(const SurfaceModel& surface, const Arc& arc, const ArcPatch& patch,
                           const AreaWeights& weights, Quantity sas_quantity, Quantity ses_quantity,
                           GradientTerms& terms) {
  const auto& [one, two, circle] = std::tie(patch.first, patch.second, patch.circle);
  const double angle = patch.swept.angle;
  const double first_weight = weights[arc.first], second_weight = weights[arc.second];
  face_gradient(patch, first_weight * squared(one.radius), second_weight * squared(two.radius))
      .add_to(terms, sas_quantity, arc, circle);

  CircleGradient area =
      face_gradient(patch, first_weight * squared(surface.atoms[arc.first].radius),
                    second_weight * squared(surface.atoms[arc.second].radius));
  const double rho = circle.radius;
  if (surface.probe_radius >= 0) {
    const SaddleBorder border = find_border(patch.outline, circle, one.radius, two.radius);
    const DividedSaddle saddle(patch.outline, border, first_weight, second_weight);
    // The angles are -atan(h_1 / rho) and atan(h_2 / rho).
    const double by_first = -angle * saddle.width.by_low / squared(one.radius);
    const double by_second = angle * saddle.width.by_high / squared(two.radius);
    area.first_height = by_first * rho;
    area.second_height = by_second * rho;
    area.rho = angle * saddle.width.by_rho - by_first * circle.first_height -
               by_second * circle.second_height;
    area.resolve(circle, one.radius, two.radius);
    // The sine of the border's angle is (R_2 - R_1) / d.
    const double by_difference =
        angle * saddle.by_sine / (circle.first_height + circle.second_height);
    area.second_radius += by_difference;
    area.first_radius -= by_difference;
    area.distance -= by_difference * saddle.sine;
    terms.probe[ses_quantity] += angle * saddle.width.by_probe;
  }
  area.add_to(terms, ses_quantity, arc, circle);
}

// The surface moves with the contact circle: by cos t (e . dm + d rho) - sin t (u . dm) +
// rho sin t (e . du) - dp along its normal, with the circle's centre m and the radial vector e. The
// integral of rho sin t e is the moment of the saddle cross its axis.
void add_arc_volume_gradient(const SurfaceModel& surface, const Arc& arc, const ArcPatch& patch,
                             GradientTerms& terms) {
  const ContactCircle& circle = patch.circle;
  const SurfaceIntegrals& saddle = patch.saddle;
  const double p = surface.probe_radius, rho = circle.radius;
  if (p <= 0 || rho == 0) return;
  CircleGradient volume;
  volume.axis = circle.first_height * saddle.vector_area + cross(saddle.moment, circle.axis);
  volume.first_height = dot(saddle.vector_area, circle.axis);
  volume.rho = (saddle.flux + p * saddle.area) / rho;
  volume.resolve(circle, patch.first.radius, patch.second.radius);
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

}  // namespace eses::detail
