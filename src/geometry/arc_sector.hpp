#pragma once
/// The half planes of an arc, about its circle's axis, and the directions between them.

#include <algorithm>

#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"

namespace eses::detail {

struct ArcSector {
  ArcKind kind = ArcKind::full;
  Vec3 start;         ///< unit, from the circle's centre to the arc's start
  Vec3 end;           ///< likewise to its end
  Vec3 start_normal;  ///< axis x start: positive on the arc's side of the half plane at the start
  Vec3 end_normal;    ///< end x axis
};

inline ArcSector make_arc_sector(Vec3 axis, ArcKind kind, Vec3 start, Vec3 end) {
  if (kind == ArcKind::full) start = end = any_perpendicular(axis);
  return {kind, start, end, cross(axis, start), cross(end, axis)};
}

/// Whether the circle's point nearest to `offset` (from the centre) lies on the arc, seams
/// included. On the axis every point of the circle is nearest.
inline bool projects_onto_arc(const ArcSector& sector, Vec3 offset) {
  if (sector.kind == ArcKind::full) return true;
  const bool after_start = dot(sector.start_normal, offset) >= -tolerance::seam;
  const bool before_end = dot(sector.end_normal, offset) >= -tolerance::seam;
  if (sector.kind == ArcKind::major) return after_start || before_end;
  return after_start && before_end && dot(sector.start + sector.end, offset) >= -tolerance::seam;
}

/// Bounds of the unit vectors from the circle's centre to its points on the arc: of its ends and of
/// those extremes of the circle that lie on it.
inline Box direction_bounds(const ArcSector& sector, Vec3 axis) {
  Box bounds{sector.start, sector.start};
  bounds.include(sector.end);
  for (std::size_t q = 0; q < 3; ++q) {
    const double reach = std::sqrt(std::max(0.0, (1 - axis[q]) * (1 + axis[q])));
    if (sector.kind == ArcKind::full) {
      bounds.low[q] = -reach;
      bounds.high[q] = reach;
      continue;
    }
    Vec3 upward = -axis[q] * axis;  // towards the circle's highest point along q, times reach
    upward[q] += 1;
    if (projects_onto_arc(sector, upward)) bounds.high[q] = reach;
    if (projects_onto_arc(sector, -upward)) bounds.low[q] = -reach;
  }
  return bounds;
}

/// The box of what lies around `center` at distance `radius` in the directions given.
inline Box arc_box(Vec3 center, double radius, const Box& directions) {
  return {center + radius * directions.low, center + radius * directions.high};
}

inline void include_arc(Box& box, Vec3 center, double radius, const Box& directions) {
  const Box arc = arc_box(center, radius, directions);
  box.include(arc.low);
  box.include(arc.high);
}

}  // namespace eses::detail
