/// The search for crossings with spherical patches: convex and concave ones. Highway includes this
/// file once for each instruction set.

#include "grid/block_crossing.hpp"
#include "solve/candidates-inl.hpp"
#include "solve/cone_filter-inl.hpp"
#include "solve/crossing.hpp"
#include "solve/line_sphere-inl.hpp"

#if defined(ESES_SOLVE_SEARCH_SPHERES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_SEARCH_SPHERES_INL_
#undef ESES_SOLVE_SEARCH_SPHERES_INL_
#else
#define ESES_SOLVE_SEARCH_SPHERES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// The search in convex patches.
struct FaceSearch : Candidates {
  // Adds the points in which edges enter a convex patch: a van der Waals sphere in the directions
  // of its exposed face.
  void search(const FaceFeature& face) {
    const bool is_point = is_point_atom(face);
    ConeFilter filter(features.cones_of(face));
    for_each_axis([&](auto axis) {
      const auto is_exposed = [&](DoubleMask met, Points direction, DoubleVector length, int side) {
        if (is_point) {
          direction = {broadcast(0), broadcast(0), broadcast(0)};
          along<axis()>(direction) = broadcast(side);
          length = broadcast(1);
        }
        return filter.outside(met, direction, [&](const CapCone& cone) {
          return broadcast(cone.cosine) * length + broadcast(tolerance::seam);
        });
      };
      meet_lines<axis()>(grid, {face.center, face.radius, face.surface_box}, is_exposed,
                         [&](const GridIndex& line, double met, int side, Vec3 direction) {
                           if (features.is_filled(face, direction)) return;
                           BlockCrossing crossing{met,    direction, {face.atom}, 0,
                                                  axis(), 1,         side > 0};
                           if (is_point) {
                             crossing.normal = {};
                             crossing.normal[axis()] = side;
                           }
                           add_on_line(line, crossing);
                         });
    });
  }
};

// The search in concave patches.
struct PlacementSearch : Candidates {
  // Adds the points in which edges cross a concave patch: a probe's sphere in the directions of the
  // placement's normal cone. If the cone is not known, the whole sphere is used, and each candidate
  // needs a proof.
  void search(const PlacementFeature& placement) {
    const auto is_in_cone = [&](DoubleMask met, const Points& direction, DoubleVector, int) {
      if (!placement.is_regular) return met;
      for (const Vec3& normal : placement.cone)
        met = hn::And(met, dot(normal, direction) >= broadcast(-tolerance::seam));
      return met;
    };
    for_each_axis([&](auto axis) {
      meet_lines<axis()>(grid, {placement.center, features.probe_radius, placement.box}, is_in_cone,
                         [&](const GridIndex& line, double met, int side, Vec3 direction) {
                           add_on_line(line,
                                       {met, -direction, placement.atoms, 0, axis(), 3, side < 0},
                                       !placement.is_regular);
                         });
    });
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
