/// Intersections of several grid lines with a sphere. One square root gives the intersections of
/// all edges of a line. Highway includes this file once for each instruction set.

#include "solve/axis_range.hpp"
#include "system/points-inl.hpp"

#if defined(ESES_SOLVE_LINE_SPHERE_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_LINE_SPHERE_INL_
#undef ESES_SOLVE_LINE_SPHERE_INL_
#else
#define ESES_SOLVE_LINE_SPHERE_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// The part of a sphere in a box.
struct SpherePart {
  Vec3 center;
  double radius = 0;
  Box box;
  /// Whether the directions from the centre are lost in rounding. Those along the lines are taken.
  bool is_point = false;
};

/// Slack for lines that graze a sphere, square angstrom.
inline constexpr double tangent_slack = -1e-12;

/// Returns vectors of length 1 along these axes, with these signs.
HWY_INLINE Points units_along(const LaneAxes& axes, DoubleVector signs) {
  const auto zero = hn::Zero(Doubles());
  return axes.with({zero, zero, zero}, hn::CopySignToAbs(broadcast(1), signs));
}

/// Calls `found(line, coordinate, direction)` for each point in which a grid line along `axis`
/// through owned points of the block enters the part of the sphere, if `side` is -1, or leaves it,
/// if `side` is 1. `line` has the indices of the line's points; the index along the axis is
/// unspecified. `direction` is the unit vector from the sphere's centre. `is_on_patch(mask,
/// from_center, length)` returns the lanes of `mask` whose points are on the patch.
template <std::size_t axis, class IsOnPatch, class Found>
void meet_lines(const BlockGrid& grid, const SpherePart& sphere, double side,
                IsOnPatch&& is_on_patch, Found&& found) {
  constexpr std::size_t across = axis == 0 ? 1 : 0, row = axis == 2 ? 1 : 2;
  const Doubles doubles;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(doubles));
  const AxisRange rows = own_points_within(grid, row, sphere.box.low[row], sphere.box.high[row]);
  const AxisRange columns =
      own_points_within(grid, across, sphere.box.low[across], sphere.box.high[across]);
  const auto low = broadcast(sphere.box.low[axis]), high = broadcast(sphere.box.high[axis]);
  const auto center = broadcast(sphere.center[axis]);
  for (std::int64_t k = rows.begin; k < rows.end; ++k) {
    // With g++, a constructor that the compiler makes lacks the instruction set of the vectors.
    Points offset{broadcast(0), broadcast(0), broadcast(0)};
    along<row>(offset) =
        broadcast(grid.coordinates[row][static_cast<std::size_t>(k)] - sphere.center[row]);
    const auto squared_row = along<row>(offset) * along<row>(offset);
    for (std::int64_t j = columns.begin; j < columns.end; j += lanes) {
      along<across>(offset) =
          load(grid.coordinates[across].data() + j) - broadcast(sphere.center[across]);
      const auto squared = broadcast(sphere.radius * sphere.radius) -
                           (along<across>(offset) * along<across>(offset) + squared_row);
      const auto meets = hn::And(squared >= broadcast(tangent_slack),
                                 hn::FirstN(doubles, static_cast<std::size_t>(columns.end - j)));
      if (hn::AllFalse(doubles, meets)) continue;
      along<axis>(offset) = broadcast(side) * hn::Sqrt(hn::Max(squared, hn::Zero(doubles)));
      const auto coordinate = center + along<axis>(offset);
      auto met = hn::And(meets, hn::And(coordinate >= low, coordinate <= high));
      if (hn::AllFalse(doubles, met)) continue;
      const Points from_center = sphere.is_point
                                     ? units_along(LaneAxes(broadcast(axis)), broadcast(side))
                                     : Points{offset.x, offset.y, offset.z};
      const auto length = hn::Sqrt(squared_norm(from_center));
      met = is_on_patch(met, from_center, length);
      if (hn::AllFalse(doubles, met)) continue;
      const LaneValues coordinates(coordinate);
      const LanePoints directions(broadcast(1) / length * from_center);
      for_each_lane(met, [&](std::size_t lane) {
        GridIndex line{};
        line[row] = k;
        line[across] = j + static_cast<std::int64_t>(lane);
        found(line, coordinates[lane], directions[lane]);
      });
    }
  }
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
