/// Positions of several points relative to contact circles and arcs. Highway includes this file
/// once for each instruction set.

#include "geometry/arc_sector.hpp"
#include "geometry/contact_circle.hpp"
#include "system/points-inl.hpp"

#if defined(ESES_GEOMETRY_ARC_SECTOR_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_GEOMETRY_ARC_SECTOR_INL_
#undef ESES_GEOMETRY_ARC_SECTOR_INL_
#else
#define ESES_GEOMETRY_ARC_SECTOR_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// The MeridianPoint of several points, one in each lane.
struct MeridianPoints {
  DoubleVector height, inward;
};

/// Returns the meridian coordinates of the points at `offset` from the circle's centre.
HWY_INLINE MeridianPoints meridian_points(const ContactCircle& circle, const Points& offset) {
  const auto height = dot(circle.axis, offset);
  return {height, broadcast(circle.radius) - hn::Sqrt(squared_norm(offset - height * circle.axis))};
}

/// Returns the lanes on which the circle's point nearest to `offset` lies on the arc. See
/// projects_onto_arc() in arc_sector.hpp.
HWY_INLINE DoubleMask projects_onto_arc(const ArcSector& sector, const Points& offset) {
  const auto seam = broadcast(-tolerance::seam);
  if (sector.kind == ArcKind::full) return seam < broadcast(0);
  const auto after_start = dot(sector.start_normal, offset) >= seam;
  const auto before_end = dot(sector.end_normal, offset) >= seam;
  if (sector.kind == ArcKind::major) return hn::Or(after_start, before_end);
  return hn::And(hn::And(after_start, before_end), dot(sector.start + sector.end, offset) >= seam);
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
