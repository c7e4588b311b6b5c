/// Intersections of several grid edges with a part of a sphere. Highway includes this file once for
/// each instruction set.

#include "geometry/tolerances.hpp"
#include "solve/edge_batch-inl.hpp"
#include "solve/line_sphere-inl.hpp"

#if defined(ESES_SOLVE_EDGE_SPHERE_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_EDGE_SPHERE_INL_
#undef ESES_SOLVE_EDGE_SPHERE_INL_
#else
#define ESES_SOLVE_EDGE_SPHERE_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Calls `found(key, coordinate, direction)` for each edge of the batch that meets the part of the
/// sphere on its way out: at the end of the chord that lies towards the outside end if `side` is 1,
/// and towards the inside end if it is -1. `coordinate` is that along the edge's axis. Then calls
/// `count(edges, coordinates, directions, lanes)` for the lanes for which it returned true. See
/// meet_lines() for the other arguments. Empties the batch.
template <class IsOnPatch, class Found, class Count>
HWY_INLINE void meet_sphere(const SpherePart& sphere, double side, EdgeBatch& batch,
                            IsOnPatch&& is_on_patch, Found&& found, Count&& count) {
  const Doubles doubles;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(doubles)) {
    const LaneEdges edges(batch, i, sphere.center);
    const LaneAxes& axes = edges.axes;
    const Points across = axes.with(edges.start, hn::Zero(doubles));
    const auto squared = broadcast(sphere.radius * sphere.radius) - squared_norm(across);
    const auto half_chord = hn::Sqrt(hn::Max(squared, hn::Zero(doubles)));
    const auto outwards = broadcast(side) * (edges.from - edges.to);
    const auto along = hn::CopySignToAbs(half_chord, outwards);
    const auto coordinate = axes.of(sphere.center) + along;
    const auto low = hn::Min(edges.from, edges.to), high = hn::Max(edges.from, edges.to);
    const auto slack = broadcast(tolerance::edge_end) * (high - low);
    auto met = hn::And(squared >= broadcast(tangent_slack), hn::FirstN(doubles, batch.count - i));
    met = hn::And(met, hn::And(coordinate >= low - slack, coordinate <= high + slack));
    met = hn::And(met, hn::And(coordinate >= axes.of(sphere.box.low),
                               coordinate <= axes.of(sphere.box.high)));
    if (hn::AllFalse(doubles, met)) continue;
    const Points offset = sphere.is_point ? units_along(axes, outwards) : axes.with(across, along);
    const auto length = hn::Sqrt(squared_norm(offset));
    met = is_on_patch(met, offset, length);
    if (hn::AllFalse(doubles, met)) continue;
    const auto on_edge = hn::Min(hn::Max(coordinate, low), high);
    const Points direction = broadcast(1) / length * offset;
    const LaneValues coordinates(on_edge);
    const LanePoints directions(direction);
    const auto counted = lanes_where(met, [&](std::size_t lane) {
      return found(batch.key[i + lane], coordinates[lane], directions[lane]);
    });
    count(edges, on_edge, direction, counted);
  }
  batch.count = 0;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
