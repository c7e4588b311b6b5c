#include "geometry/line_torus.hpp"

#include <cmath>

namespace eses::detail {
namespace {

// Bernstein coefficients of a quartic on [0, 1].
using Quartic = std::array<double, 5>;

// Returns the number of sign changes, which is an upper bound for the number of roots in [0, 1].
int sign_changes(const Quartic& b) {
  int changes = 0;
  for (std::size_t i = 1; i < b.size(); ++i) changes += (b[i - 1] < 0) != (b[i] < 0);
  return changes;
}

// Converts power coefficients, constant term first, to Bernstein coefficients.
Quartic bernstein(const std::array<double, 5>& power) {
  const auto [c0, c1, c2, c3, c4] = power;
  return {c0, c0 + c1 / 4, c0 + c1 / 2 + c2 / 6, c0 + 3 * c1 / 4 + c2 / 2 + c3 / 4,
          c0 + c1 + c2 + c3 + c4};
}

// Computes the Bernstein coefficients on [0, 1/2] and on [1/2, 1] by de Casteljau's algorithm.
void halve(const Quartic& b, Quartic& left, Quartic& right) {
  Quartic work = b;
  left[0] = b[0];
  right[4] = b[4];
  for (std::size_t level = 1; level < 5; ++level) {
    for (std::size_t i = 0; i + level < 5; ++i) work[i] = 0.5 * (work[i] + work[i + 1]);
    left[level] = work[0];
    right[4 - level] = work[4 - level];
  }
}

struct ValueAndSlope {
  double value, slope;
};

// Evaluates a polynomial in power coefficients and its derivative by Horner's method.
ValueAndSlope evaluate(const std::array<double, 5>& c, double u) {
  double value = c[4], slope = 0;
  for (std::size_t i = 4; i-- > 0;) {
    slope = slope * u + value;
    value = value * u + c[i];
  }
  return {value, slope};
}

// Returns the root of a polynomial in a bracket that contains exactly one root, and in which the
// polynomial rises from negative to positive. Uses Newton's method from `u`, and a bisection
// instead of a step that would leave the bracket.
double bracketed_root(const std::array<double, 5>& c, double low, double high, double u) {
  for (int iteration = 0; iteration < line_torus::max_iterations; ++iteration) {
    const auto [value, slope] = evaluate(c, u);
    (value < 0 ? low : high) = u;
    double next = u - value / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::fabs(next - u);
    u = next;
    if (step < line_torus::last_step) break;
  }
  return u;
}

// A search for the roots at which a quartic rises. There the line passes from the inside of the
// tube, where the quartic is negative, to the outside.
struct RootSearch {
  const std::array<double, 5>& power;
  std::array<double, 4> roots{};
  int count = 0;

  // Halves [low, high] until each part has at most one sign change. `b` has the Bernstein
  // coefficients on this interval.
  void descend(const Quartic& b, double low, double high) {
    const int changes = sign_changes(b);
    if (changes == 0) return;
    constexpr double narrow = 1e-12;
    if (changes == 1 || high - low < narrow) {
      if (b[0] < 0 && b[4] >= 0 && count < 4)
        roots[static_cast<std::size_t>(count++)] =
            bracketed_root(power, low, high, low + (high - low) * (b[0] / (b[0] - b[4])));
      return;
    }
    Quartic left, right;
    halve(b, left, right);
    const double middle = 0.5 * (low + high);
    descend(left, low, middle);
    descend(right, middle, high);
  }
};

// Improves a root by one Newton step on A - 2 rho s. This function is better conditioned than its
// product with A + 2 rho s, the quartic: on the axis of a spindle torus both factors vanish.
double polished(double u, Vec3 first, Vec3 span, Vec3 axis, double circle_radius,
                double tube_radius) {
  const Vec3 w = first + u * span;
  const Vec3 across = w - dot(w, axis) * axis;
  const double s = norm(across);
  const double value = squared_norm(w) +
                       (circle_radius - tube_radius) * (circle_radius + tube_radius) -
                       2 * circle_radius * s;
  const double slope = 2 * dot(w, span) - (s > 0 ? 2 * circle_radius * dot(across, span) / s : 0.0);
  const double step = value / slope;
  return std::fabs(step) < line_torus::max_polish ? u - step : u;
}

}  // namespace

TubeExits tube_exits(Vec3 start, Vec3 step, Vec3 axis, double circle_radius, double tube_radius,
                     double low, double high) {
  // The substitution w = first + u span with u in [0, 1] gives |w|^2 = w0 + w1 u + w2 u^2,
  // z = z0 + z1 u, and s^2 = |w|^2 - z^2.
  const Vec3 first = start + low * step;
  const Vec3 span = (high - low) * step;
  const double w0 = squared_norm(first), w1 = 2 * dot(first, span), w2 = squared_norm(span);
  const double a0 = w0 + (circle_radius - tube_radius) * (circle_radius + tube_radius);
  const double z0 = dot(first, axis), z1 = dot(span, axis);
  const double k = 4 * circle_radius * circle_radius;
  const std::array<double, 5> power{
      a0 * a0 - k * (w0 - z0 * z0), 2 * a0 * w1 - k * (w1 - 2 * z0 * z1),
      w1 * w1 + 2 * a0 * w2 - k * (w2 - z1 * z1), 2 * w1 * w2, w2 * w2};
  const Quartic b = bernstein(power);
  TubeExits exits;
  if (sign_changes(b) == 0) return exits;
  RootSearch search{power};
  search.descend(b, 0, 1);
  const double inner_sheet = line_torus::inner_sheet(tube_radius);
  for (int i = 0; i < search.count; ++i) {
    const double u = search.roots[static_cast<std::size_t>(i)];
    // A root with A < 0 lies on the inner sheet, where the far side of the circle is at distance p.
    if (a0 + u * (w1 + u * w2) < inner_sheet) continue;
    const double exact = polished(u, first, span, axis, circle_radius, tube_radius);
    exits.parameters[static_cast<std::size_t>(exits.count++)] =
        std::clamp(low + exact * (high - low), low, high);
  }
  return exits;
}

}  // namespace eses::detail
