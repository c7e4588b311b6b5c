#include "surface/saddle.hpp"

#include <algorithm>

namespace eses::detail {
namespace {

// With the radial unit vector e, the axis u and the angle t along the outline, a point of the
// saddle is (rho - p cos t) e + p sin t u, its outward normal is cos t e - sin t u, the cross
// product of both is -rho sin t (e x u), and the element of area is p (rho - p cos t) dt dphi
// (Connolly, J. Appl. Cryst. 16, 548, 1983, doi:10.1107/S0021889883010985).
SurfaceIntegrals integrate(const SaddleOutline& outline, const OutlineRange& range, Vec3 axis,
                           const SweptArc& arc) {
  const auto [rho, p] = std::pair(outline.rho, outline.probe);
  const auto [sin_low, cos_low] = range.low;
  const auto [sin_high, cos_high] = range.high;
  const double length = range.length();
  const double cosine = sin_high - sin_low;  // integrals of cos t, sin t and their products
  const double sine = cos_low - cos_high;
  const double cosine_squared = 0.5 * (length + sin_high * cos_high - sin_low * cos_low);
  const double sine_cosine = 0.5 * (sin_high - sin_low) * (sin_high + sin_low);
  const double weight = rho * length - p * cosine;  // integral of rho - p cos t
  const double weight_cosine = rho * cosine - p * cosine_squared;
  const double weight_sine = rho * sine - p * sine_cosine;
  return {arc.angle * p * weight,
          p * (weight_cosine * arc.radial - (arc.angle * weight_sine) * axis),
          arc.angle * p * (rho * weight_cosine - p * weight),
          (p * rho * weight_sine) * cross(axis, arc.radial)};
}

}  // namespace

SaddleOutline make_outline(const ContactCircle& circle, double probe) {
  const auto contact = [&](double height) {
    const double distance = std::sqrt(circle.radius * circle.radius + height * height);
    return distance > 0 ? OutlinePoint{height / distance, circle.radius / distance}
                        : OutlinePoint();
  };
  SaddleOutline outline{
      circle.radius, probe, {contact(-circle.first_height), contact(circle.second_height)}, {}};
  if (circle.radius < probe) {
    const double cosine = circle.radius / probe;
    outline.cusp = {std::sqrt((1 - cosine) * (1 + cosine)), cosine};
  }
  return outline;
}

SaddleBorder find_border(const SaddleOutline& outline, const ContactCircle& circle,
                         double first_radius, double second_radius) {
  const double distance = circle.first_height + circle.second_height;
  const double sine = std::clamp((second_radius - first_radius) / distance, -1.0, 1.0);
  const auto& [low, high] = outline.contact;
  if (sine <= low.sine) return {low, sine};
  if (sine >= high.sine) return {high, sine};
  return {{sine, std::sqrt((1 - sine) * (1 + sine))}, sine};
}

SurfaceIntegrals saddle_integrals(const SaddleOutline& outline, const OutlineRange& range,
                                  Vec3 axis, const SweptArc& arc) {
  SurfaceIntegrals sum;
  outline.for_each_part(
      range, [&](const OutlineRange& part) { sum += integrate(outline, part, axis, arc); });
  return sum;
}

}  // namespace eses::detail
