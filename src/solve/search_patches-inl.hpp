/// The search for crossings patch by patch. Highway includes this file once for each instruction
/// set.

#include "geometry/block_crossing.hpp"
#include "solve/candidates-inl.hpp"
#include "solve/cone_filter-inl.hpp"
#include "solve/crossing.hpp"
#include "solve/edge_saddle-inl.hpp"
#include "solve/edge_sphere-inl.hpp"
#include "solve/gather_edges-inl.hpp"
#include "solve/patch_tally-inl.hpp"

#if defined(ESES_SOLVE_SEARCH_PATCHES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_SEARCH_PATCHES_INL_
#undef ESES_SOLVE_SEARCH_PATCHES_INL_
#else
#define ESES_SOLVE_SEARCH_PATCHES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// The sphere of a convex patch, and the directions on the patch: those of an exposed face.
struct FacePart {
  SpherePart sphere;
  ConeFilter filter;

  HWY_INLINE FacePart(const BlockFeatures& features, const FaceFeature& face)
      : sphere{face.center, face.radius, face.surface_box, is_point_atom(face)},
        filter(features.cones_of(face)) {}
  HWY_INLINE DoubleMask operator()(DoubleMask met, const Points& direction, DoubleVector length) {
    return filter.outside(met, direction, [&](const CapCone& cone) {
      return broadcast(cone.cosine) * length + broadcast(tolerance::seam);
    });
  }
};

// The sphere of a concave patch, and the directions on the patch: those of the placement's normal
// cone. If the cone is not known, they are all directions.
struct PlacementPart {
  SpherePart sphere;
  const PlacementFeature& placement;

  HWY_INLINE PlacementPart(const BlockFeatures& features, const PlacementFeature& of)
      : sphere{of.center, features.probe_radius, of.box}, placement(of) {}
  HWY_INLINE DoubleMask operator()(DoubleMask met, const Points& direction, DoubleVector) const {
    if (!placement.is_regular) return met;
    for (const Vec3& normal : placement.cone)
      met = hn::And(met, dot(normal, direction) >= broadcast(-tolerance::seam));
    return met;
  }
};

// Adds the points in which edges cross patches. Only edges that meet the box of a patch are tested.
struct PatchSearch : Candidates {
  // Edges leave an atom.
  void search(const FaceFeature& face) {
    FacePart part(features, face);
    PatchTally<1> sums(surface, {face.atom}, grid.inverse_spacing, tally);
    for_edges_near(*this, face.surface_box, [&] {
      meet_sphere(
          part.sphere, 1, scratch.batch, part,
          [&](std::uint64_t key, double met, Vec3 direction) {
            return !features.is_filled(face, direction) &&
                   add_candidate(key, {met, direction, {face.atom}, 0, 0, 1, false});
          },
          sums);
      sums.flush();
    });
  }

  void search(const ArcFeature& arc) {
    PatchTally<2> sums(surface, arc.atoms, grid.inverse_spacing, tally);
    for_edges_near(*this, arc.surface_box, [&] {
      meet_saddle(
          arc, features.probe_radius, grid.grid.spacing, scratch.batch,
          [&](std::uint64_t key, double met, Vec3 normal) {
            return add_candidate(key, {met, normal, {arc.atoms[0], arc.atoms[1]}, 0, 0, 2, false});
          },
          sums);
      sums.flush();
    });
  }

  // Edges enter a probe. If the normal cone is not known, each crossing needs a proof.
  void search(const PlacementFeature& placement) {
    const PlacementPart part(features, placement);
    PatchTally<3> sums(surface, placement.atoms, grid.inverse_spacing, tally);
    for_edges_near(*this, placement.box, [&] {
      meet_sphere(
          part.sphere, -1, scratch.batch, part,
          [&](std::uint64_t key, double met, Vec3 direction) {
            return add_candidate(key, {met, -direction, placement.atoms, 0, 0, 3, false},
                                 !placement.is_regular);
          },
          sums);
      sums.flush();
    });
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
