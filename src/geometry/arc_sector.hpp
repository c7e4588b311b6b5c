#pragma once
/// The sector of directions about a circle's axis that belongs to an arc.

#include <algorithm>

#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"

namespace eses::detail {

/// The directions from a circle's centre between the two half planes through the ends of an arc.
struct ArcSector {
  ArcKind kind = ArcKind::full;
  Vec3 start;         ///< unit vector from the circle's centre to the arc's start
  Vec3 end;           ///< unit vector from the circle's centre to the arc's end
  Vec3 start_normal;  ///< axis x start: normal of the start's half plane, towards the arc
  Vec3 end_normal;    ///< end x axis: normal of the end's half plane, towards the arc
};

inline ArcSector make_arc_sector(Vec3 axis, ArcKind kind, Vec3 start, Vec3 end) {
  if (kind == ArcKind::full) start = end = any_perpendicular(axis);
  return {kind, start, end, cross(axis, start), cross(end, axis)};
}

/// Returns whether the circle's point nearest to `offset` lies on the arc, seams included. `offset`
/// is relative to the circle's centre. On the axis, all points of the circle are nearest.
inline bool projects_onto_arc(const ArcSector& sector, Vec3 offset) {
  if (sector.kind == ArcKind::full) return true;
  const bool after_start = dot(sector.start_normal, offset) >= -tolerance::seam;
  const bool before_end = dot(sector.end_normal, offset) >= -tolerance::seam;
  if (sector.kind == ArcKind::major) return after_start || before_end;
  return after_start && before_end && dot(sector.start + sector.end, offset) >= -tolerance::seam;
}

/// Returns the bounding box of the unit vectors from the circle's centre to the points of the arc.
/// It is the box of the arc's ends and of the circle's extreme points that lie on the arc.
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
    Vec3 upward = -axis[q] * axis;  // direction of the circle's highest point along q
    upward[q] += 1;
    if (projects_onto_arc(sector, upward)) bounds.high[q] = reach;
    if (projects_onto_arc(sector, -upward)) bounds.low[q] = -reach;
  }
  return bounds;
}

/// Returns the bounding box of the points at distance `radius` from `center` in these directions.
inline Box arc_box(Vec3 center, double radius, const Box& directions) {
  return {center + radius * directions.low, center + radius * directions.high};
}

/// Extends `box` by the box of an arc.
inline void include_arc(Box& box, Vec3 center, double radius, const Box& directions) {
  const Box arc = arc_box(center, radius, directions);
  box.include(arc.low);
  box.include(arc.high);
}

}  // namespace eses::detail
