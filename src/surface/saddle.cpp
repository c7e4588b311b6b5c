#include "surface/saddle.hpp"

#include <algorithm>
#include <cmath>

namespace eses::detail {
namespace {

// With the radial unit vector e, the axis u and the angle t along the outline, a point of the
// saddle is (rho - p cos t) e + p sin t u, its outward normal is cos t e - sin t u, and the element
// of area is p (rho - p cos t) dt dphi (Connolly, J. Appl. Cryst. 16, 548, 1983,
// doi:10.1107/S0021889883010985).
SurfaceIntegrals integrate(const SaddleOutline& outline, OutlineRange range, Vec3 axis,
                           const SweptArc& arc) {
  const auto [rho, p] = std::pair(outline.rho, outline.probe);
  const double sin_low = std::sin(range.low), sin_high = std::sin(range.high);
  const double cos_low = std::cos(range.low), cos_high = std::cos(range.high);
  const double length = range.high - range.low;
  const double cosine = sin_high - sin_low;  // integrals of cos t, sin t and their products
  const double sine = cos_low - cos_high;
  const double cosine_squared = 0.5 * (length + sin_high * cos_high - sin_low * cos_low);
  const double sine_cosine = 0.5 * (sin_high - sin_low) * (sin_high + sin_low);
  const double weight = rho * length - p * cosine;  // integral of rho - p cos t
  const double weight_cosine = rho * cosine - p * cosine_squared;
  return {arc.angle * p * weight,
          p * (weight_cosine * arc.radial - (arc.angle * (rho * sine - p * sine_cosine)) * axis),
          arc.angle * p * (rho * weight_cosine - p * weight)};
}

}  // namespace

SaddleOutline make_outline(const ContactCircle& circle, double probe) {
  return {circle.radius,
          probe,
          {-std::atan2(circle.first_height, circle.radius),
           std::atan2(circle.second_height, circle.radius)},
          circle.radius < probe ? std::acos(circle.radius / probe) : 0};
}

SaddleBorder find_border(const SaddleOutline& outline, const ContactCircle& circle,
                         double first_radius, double second_radius) {
  const double distance = circle.first_height + circle.second_height;
  const double sine = std::clamp((second_radius - first_radius) / distance, -1.0, 1.0);
  return {std::clamp(std::asin(sine), outline.contact.low, outline.contact.high), sine};
}

SurfaceIntegrals saddle_integrals(const SaddleOutline& outline, OutlineRange range, Vec3 axis,
                                  const SweptArc& arc) {
  if (outline.cusp == 0)
    return range.low < range.high ? integrate(outline, range, axis, arc) : SurfaceIntegrals{};
  SurfaceIntegrals sum;
  const OutlineRange below{range.low, std::min(range.high, -outline.cusp)};
  const OutlineRange above{std::max(range.low, outline.cusp), range.high};
  if (below.low < below.high) sum += integrate(outline, below, axis, arc);
  if (above.low < above.high) sum += integrate(outline, above, axis, arc);
  return sum;
}

}  // namespace eses::detail
