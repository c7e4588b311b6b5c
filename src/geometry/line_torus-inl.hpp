/// Exits of several lines along coordinate axes from a tube, for lines with at most one exit. See
/// line_torus.hpp for the equations. Highway includes this file once for each instruction set.

#include "geometry/line_torus.hpp"
#include "system/points-inl.hpp"

#if defined(ESES_GEOMETRY_LINE_TORUS_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_GEOMETRY_LINE_TORUS_INL_
#undef ESES_GEOMETRY_LINE_TORUS_INL_
#else
#define ESES_GEOMETRY_LINE_TORUS_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// The only exit of each line.
struct OnlyTubeExits {
  DoubleVector parameters;
  DoubleMask is_one;          ///< lines with exactly this exit
  DoubleMask may_be_several;  ///< lines that may have several exits, which tube_exits() finds
};

/// Returns one root for each active lane, as bracketed_root() does. A lane that has converged keeps
/// its value, so that no lane depends on the others.
HWY_INLINE DoubleVector bracketed_roots(const std::array<DoubleVector, 5>& c, DoubleVector u,
                                        DoubleMask active) {
  const Doubles doubles;
  auto low = broadcast(0), high = broadcast(1);
  for (int i = 0; i < line_torus::max_iterations; ++i) {
    const auto slope =
        ((broadcast(4) * c[4] * u + broadcast(3) * c[3]) * u + broadcast(2) * c[2]) * u + c[1];
    const auto value = (((c[4] * u + c[3]) * u + c[2]) * u + c[1]) * u + c[0];
    const auto is_below = value < broadcast(0);
    low = hn::IfThenElse(is_below, u, low);
    high = hn::IfThenElse(is_below, high, u);
    auto next = u - value / slope;
    const auto is_inside = hn::And(next >= low, next <= high);
    next = hn::IfThenElse(is_inside, next, broadcast(0.5) * (low + high));
    const auto step = hn::Abs(next - u);
    u = hn::IfThenElse(active, next, u);
    active = hn::And(active, step >= broadcast(line_torus::last_step));
    if (hn::AllFalse(doubles, active)) break;
  }
  return u;
}

/// Improves roots as polished() does.
HWY_INLINE DoubleVector polished_roots(DoubleVector u, const Points& point, DoubleVector along_step,
                                       DoubleVector span, Vec3 axis, DoubleVector axis_step,
                                       double circle_radius, double tube_radius) {
  const auto height = dot(axis, point);
  const auto s = hn::Sqrt(squared_norm(point - height * axis));
  const auto value = squared_norm(point) +
                     broadcast((circle_radius - tube_radius) * (circle_radius + tube_radius)) -
                     broadcast(2 * circle_radius) * s;
  const auto across_span = span * (along_step - height * axis_step);
  const auto turn =
      hn::IfThenElseZero(s > broadcast(0), broadcast(2 * circle_radius) * across_span / s);
  const auto step = value / (broadcast(2) * along_step * span - turn);
  return hn::IfThenElse(hn::Abs(step) < broadcast(line_torus::max_polish), u - step, u);
}

/// Returns the exits of the lines from `start` along the coordinate axes `along` by `step`, with
/// the parameters and results of tube_exits().
HWY_INLINE OnlyTubeExits only_tube_exits(const LaneAxes& along, const Points& start,
                                         DoubleVector step, Vec3 axis, double circle_radius,
                                         double tube_radius, double low, double high) {
  const Doubles doubles;
  const auto zero = hn::Zero(doubles);
  const auto span = broadcast(high - low) * step;
  const Points first = along.moved(start, broadcast(low) * step);
  const auto w0 = squared_norm(first), w1 = broadcast(2) * along.of(first) * span;
  const auto w2 = span * span;
  const auto a0 = w0 + broadcast((circle_radius - tube_radius) * (circle_radius + tube_radius));
  const auto axis_step = along.of(axis);
  const auto z0 = dot(axis, first), z1 = axis_step * span;
  const auto k = broadcast(4 * circle_radius * circle_radius);
  const std::array<DoubleVector, 5> power{
      a0 * a0 - k * (w0 - z0 * z0), broadcast(2) * a0 * w1 - k * (w1 - broadcast(2) * z0 * z1),
      w1 * w1 + broadcast(2) * a0 * w2 - k * (w2 - z1 * z1), broadcast(2) * w1 * w2, w2 * w2};
  // There are at most as many roots as the Bernstein coefficients have sign changes.
  const auto quarter = broadcast(0.25), half = broadcast(0.5);
  const std::array<DoubleVector, 5> b{
      power[0], power[0] + quarter * power[1], power[0] + half * power[1] + power[2] / broadcast(6),
      power[0] + broadcast(0.75) * power[1] + half * power[2] + quarter * power[3],
      power[0] + power[1] + power[2] + power[3] + power[4]};
  auto rises = zero < zero, falls = rises;
  for (std::size_t i = 1; i < b.size(); ++i) {
    const auto was_below = b[i - 1] < zero, is_below = b[i] < zero;
    rises = hn::Or(rises, hn::AndNot(is_below, was_below));
    falls = hn::Or(falls, hn::AndNot(was_below, is_below));
  }
  OnlyTubeExits exits{zero, hn::AndNot(falls, rises), hn::And(falls, rises)};
  if (hn::AllFalse(doubles, exits.is_one)) return exits;
  const auto u = bracketed_roots(power, b[0] / (b[0] - b[4]), exits.is_one);
  exits.is_one = hn::And(exits.is_one,
                         a0 + u * (w1 + u * w2) >= broadcast(line_torus::inner_sheet(tube_radius)));
  const Points point = along.moved(first, u * span);
  const auto exact =
      polished_roots(u, point, along.of(point), span, axis, axis_step, circle_radius, tube_radius);
  exits.parameters = hn::Min(
      hn::Max(broadcast(low) + exact * broadcast(high - low), broadcast(low)), broadcast(high));
  return exits;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
