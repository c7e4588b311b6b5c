#pragma once
/// The part of the probe's sphere that one probe placement contributes to the surface.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/cap_list.hpp"
#include "geometry/float_spheres.hpp"
#include "geometry/sphere_part.hpp"
#include "surface/placement_index.hpp"

namespace eses::detail {

/// The concave patch of a placement: the directions of its normal cone that no other placement cuts
/// off. The vectors keep their memory for the next patch.
struct ConcavePatch {
  PlacementNumber number{};
  std::vector<AtomIndex> touched;  ///< the atoms that the probe touches
  std::vector<Vec3> toward;        ///< unit vectors to them, which span the cone
  /// Complements of the half spaces that bound the cone, followed by one cap for each of `cutters`.
  std::vector<SphericalCap> caps;
  std::vector<PlacementNumber> cutters;  ///< placements that cut the cone
  std::vector<Vec3> tangent;  ///< directions to placements that just touch the probe's sphere
  SpherePart cone;            ///< without cuts
  SpherePart part;

  std::size_t plane_count() const { return caps.size() - cutters.size(); }

  /// Estimate of the rounding error of the curvature at the placement (radians): that of its
  /// position, seen from the centres of the atoms. Placements within `same_placement` of each other
  /// (angstrom) have one position.
  double rounding(double same_placement, double probe_radius) const;
};

/// The placements that may cut the patches of those in a large box, and in a small box in it.
struct NearPlacements {
  SpherePositions numbers;          ///< those near the large box
  SphereList centers;               ///< of `numbers`
  FloatSpheres large, small;        ///< positions in `centers` of those near each box
  std::vector<std::int32_t> found;  ///< positions in `centers` of those near one placement

  /// The number of the placement at a position in `centers`.
  PlacementNumber number(std::int32_t position) const {
    return static_cast<PlacementNumber>(numbers.at[static_cast<std::size_t>(position)]);
  }
};

/// Scratch memory of a thread.
struct ConcaveScratch {
  SpherePartFinder finder;
  NearPlacements near;
  std::vector<PlacementNumber> node, other_node;
  std::vector<SphericalCap> caps;
  std::vector<AtomIndex> borders;  ///< touched atoms beside the owner of a part
};

/// Sets the atoms and the cone of a placement that touches three atoms.
void set_triangle(const SurfaceModel& surface, const ProbePlacement& placement,
                  ConcavePatch& patch);

/// Sets the atoms and the cone of the first placement of a node. It has no cutters.
void set_cone(const PlacementIndex& placements, PlacementNumber number, ConcaveScratch& scratch,
              ConcavePatch& patch);

/// Finds the placements that may cut the patches of those in a large box.
void find_near_large(const PlacementIndex& placements, const Box& box, NearPlacements& near);

/// Finds those of them that may cut the patches of the placements in a small box.
void find_near_small(const PlacementIndex& placements, const Box& box, NearPlacements& near);

/// Finds the cutters of a cone, and the part of it that remains. The placement is in the small box
/// of `scratch.near`.
void cut_cone(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch);

/// Returns whether another placement just touches the patch.
bool has_tangent_patch(const ConcavePatch& patch, double probe_radius);

/// Returns the part of a patch that belongs to an atom. The direction n belongs to the touched atom
/// with the smallest value of radius - n . (center of the atom - center of the probe).
/// `scratch.caps` then has the caps of the patch, followed by those of `scratch.borders`, and
/// `scratch.finder` the arcs that bound the part. `known` are meetings of the caps of the patch.
SpherePart part_of_atom(const SurfaceModel& surface, const ConcavePatch& patch, AtomIndex owner,
                        ConcaveScratch& scratch, std::span<const KnownMeeting> known = {});

}  // namespace eses::detail
