/// Intersections of several grid edges with a saddle patch. Highway includes this file once for
/// each instruction set.

#include <algorithm>
#include <cmath>

#include "geometry/arc_sector-inl.hpp"
#include "geometry/line_torus-inl.hpp"
#include "solve/block_features.hpp"
#include "solve/edge_batch-inl.hpp"

#if defined(ESES_SOLVE_EDGE_SADDLE_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_EDGE_SADDLE_INL_
#undef ESES_SOLVE_EDGE_SADDLE_INL_
#else
#define ESES_SOLVE_EDGE_SADDLE_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Returns whether points lie in the wedge of the saddle patch: in the half plane through the axis,
/// a point lies between the directions from the circle to the two atoms, and its nearest point of
/// the circle is on the arc. There no other point of the two SAS spheres is nearer than the arc.
HWY_INLINE DoubleMask is_in_wedge(const ArcFeature& arc, const Points& offset) {
  const ContactCircle& circle = arc.circle;
  const auto [height, inward] = meridian_points(circle, offset);
  const auto slack = broadcast(-tolerance::seam * circle.radius);
  const auto raised = broadcast(circle.radius) * height;
  const auto is_between = hn::And(broadcast(circle.first_height) * inward + raised >= slack,
                                  broadcast(circle.second_height) * inward - raised >= slack);
  return hn::And(is_between, projects_onto_arc(arc.sector, offset));
}

/// Returns whether edges lie wholly beyond an end of an arc.
HWY_INLINE DoubleMask passes_beyond(Vec3 end_normal, const LaneEdges& edges) {
  const auto distance = dot(end_normal, edges.start);
  const auto beyond = broadcast(-tolerance::seam);
  return hn::And(distance < beyond, distance + edges.axes.of(end_normal) * edges.step() < beyond);
}

/// Returns whether edges certainly do not cross the patch, by a test of their midpoints: from there
/// to an end, the distances to the circle and to its axis and the height change by at most half the
/// edge's length.
HWY_INLINE DoubleMask misses_saddle(const ArcFeature& arc, double probe, double length,
                                    const LaneEdges& edges) {
  const ContactCircle& circle = arc.circle;
  const double reach =
      0.5 * length * (1 + 4 * tolerance::edge_end) + tolerance::seam * (probe + circle.radius);
  const Points middle = edges.axes.moved(edges.start, broadcast(0.5) * edges.step());
  const auto [height, inward] = meridian_points(circle, middle);
  const auto squared = inward * inward + height * height;
  const double nearest = std::max(0.0, probe - reach), farthest = probe + reach;
  const auto is_far_from_tube =
      hn::Or(squared<broadcast(nearest * nearest), squared> broadcast(farthest * farthest));
  const auto raised = broadcast(circle.radius) * height;
  const auto beyond_first = raised + broadcast(circle.first_height) * inward <
                            broadcast(-reach * (circle.radius + std::fabs(circle.first_height)));
  const auto beyond_second = broadcast(circle.second_height) * inward - raised <
                             broadcast(-reach * (circle.radius + std::fabs(circle.second_height)));
  return hn::Or(is_far_from_tube, hn::Or(beyond_first, beyond_second));
}

/// Removes the edges that certainly do not cross the patch from the batch.
HWY_INLINE void keep_near_saddle(const ArcFeature& arc, double probe, double length,
                                 EdgeBatch& batch) {
  const Doubles doubles;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(doubles)) {
    const LaneEdges edges(batch, i, arc.circle.center);
    auto is_off = misses_saddle(arc, probe, length, edges);
    if (arc.sector.kind == ArcKind::minor)
      is_off = hn::Or(is_off, hn::Or(passes_beyond(arc.sector.start_normal, edges),
                                     passes_beyond(arc.sector.end_normal, edges)));
    kept += keep_edges(batch, i, hn::AndNot(is_off, hn::FirstN(doubles, batch.count - i)), kept);
  }
  batch.count = kept;
}

/// Returns the outward unit normals at points of a saddle patch, given relative to the circle's
/// centre. A normal points to the centre of the probe that touches the point, which is the nearest
/// point of the arc. See nearest_on_arc().
HWY_INLINE LanePoints saddle_normals(const ArcFeature& arc, const Points& offset, DoubleMask mask) {
  const ContactCircle& circle = arc.circle;
  const Points radial = offset - dot(circle.axis, offset) * circle.axis;
  const auto length = hn::Sqrt(squared_norm(radial));
  const Points direction = broadcast(1) / length * radial;
  const auto is_plain =
      hn::And(length > broadcast(tolerance::seam), projects_onto_arc(arc.sector, direction));
  const Points towards_probe = broadcast(circle.radius) * direction - offset;
  LanePoints normals(broadcast(1) / hn::Sqrt(squared_norm(towards_probe)) * towards_probe);
  const auto is_other = hn::AndNot(is_plain, mask);
  if (hn::AllFalse(Doubles(), is_other)) return normals;
  const LanePoints offsets(offset);
  for_each_lane(is_other, [&](std::size_t lane) {
    const Vec3 nearest = nearest_on_arc(arc, offsets[lane]);
    normals.set(lane, normalized(circle.radius * nearest - offsets[lane]));
  });
  return normals;
}

/// Calls `found(key, coordinate, normal)` for each point in which an edge of the batch crosses
/// the patch. `coordinate` is that along the edge's axis. Then calls `count(edges, coordinates,
/// normals, lanes)` for the lanes for which it returned true. Empties the batch.
template <class Found, class Count>
void meet_saddle(const ArcFeature& arc, double probe, double length, EdgeBatch& batch,
                 Found&& found, Count&& count) {
  keep_near_saddle(arc, probe, length, batch);
  const Doubles doubles;
  const ContactCircle& circle = arc.circle;
  constexpr double low = -tolerance::edge_end, high = 1 + tolerance::edge_end;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(doubles)) {
    const LaneEdges edges(batch, i, circle.center);
    const auto report = [&](DoubleVector parameter, DoubleMask exits) {
      const auto fraction = hn::Min(hn::Max(parameter, broadcast(0)), broadcast(1));
      const Points point = edges.axes.moved(edges.start, fraction * edges.step());
      exits = hn::And(exits, is_in_wedge(arc, point));
      if (hn::AllFalse(doubles, exits)) return;
      const auto on_edge = edges.from + fraction * edges.step();
      const LaneValues coordinates(on_edge);
      const LanePoints normals = saddle_normals(arc, point, exits);
      const auto counted = lanes_where(exits, [&](std::size_t lane) {
        return found(batch.key[i + lane], coordinates[lane], normals[lane]);
      });
      count(edges, on_edge, normals.points(), counted);
    };
    const auto in_batch = hn::FirstN(doubles, batch.count - i);
    const OnlyTubeExits only = only_tube_exits(edges.axes, edges.start, edges.step(), circle.axis,
                                               circle.radius, probe, low, high);
    report(only.parameters, hn::And(in_batch, only.is_one));
    for_each_lane(hn::And(in_batch, only.may_be_several), [&](std::size_t lane) {
      const std::size_t k = i + lane;
      Vec3 step;
      const auto axis = static_cast<std::size_t>(batch.axis[k]);
      const Vec3 outside{batch.x[k], batch.y[k], batch.z[k]};
      step[axis] = batch.to[k] - outside[axis];
      const TubeExits several =
          tube_exits(outside - circle.center, step, circle.axis, circle.radius, probe, low, high);
      const auto this_lane = hn::Eq(hn::Iota(doubles, 0), broadcast(static_cast<double>(lane)));
      for (int e = 0; e < several.count; ++e)
        report(broadcast(several.parameters[static_cast<std::size_t>(e)]), this_lane);
    });
  }
  batch.count = 0;
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
