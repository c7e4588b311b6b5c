#pragma once
/// The patches of single atoms.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/burial.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/neighbour_caps.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// The role of an atom in the surface.
enum class AtomExposure : std::uint8_t {
  unknown,
  contained,  ///< its SAS ball lies in another one, so it has no influence
  buried,     ///< no part of its SAS sphere is accessible
  exposed,    ///< it has an exposed face
};

/// An accessible arc of the contact circle of two atoms.
struct Arc {
  AtomIndex first = 0, second = 0;  ///< first < second
  ArcKind kind = ArcKind::full;
  /// Unit vectors from the circle's centre to the ends of the arc, which runs counter-clockwise
  /// about the direction from the first to the second atom.
  Vec3 start, end;
};

/// The atoms of a probe placement, and the side of their plane on which it lies.
struct PlacementKey {
  std::array<AtomIndex, 3> atoms{};  ///< ascending
  /// +1 on the side to which (second - first) x (third - first) points, else -1.
  std::int8_t side = 1;
  bool is_certain = true;  ///< whether the end of an arc at the placement is certain, see CircleEnd

  /// Returns whether two keys name the same placement.
  bool is_same_placement(const PlacementKey& other) const {
    return atoms == other.atoms && side == other.side;
  }
  /// Among keys of the same placement, uncertain ones come first.
  auto operator<=>(const PlacementKey&) const = default;
};

/// The patches of several atoms. Face neighbours are listed for every atom that is not proved to be
/// buried. Whether it is exposed is known only when all arcs are known.
struct BuiltPatches {
  std::vector<AtomExposure> exposure;     ///< per atom
  std::vector<std::uint32_t> face_count;  ///< per atom
  std::vector<AtomIndex> face_neighbours;
  std::vector<std::uint32_t> arc_count;  ///< per atom
  std::vector<Arc> arcs;
  std::vector<PlacementKey> placements;  ///< the ends of all arcs, with repetitions

  /// Removes all patches.
  void clear();
};

/// Scratch memory of `build_atom_patches`, one per thread.
struct AtomPatchScratch {
  NeighbourScratch near;
  CapList kept_caps;  ///< caps that can bound an accessible part or cover others
  std::vector<AtomIndex> kept_neighbours;  ///< atom of each cap of `kept_caps`
  CapList circle_caps;                     ///< those on one circle, if some differ
  BurialScratch burial;
  CrowdedCaps crowded;  ///< index of `kept_caps` if there are many
  ArcScratch arc;
  std::vector<CircleArc> arcs;
  std::vector<CircleEnd> ends;
};

/// Replaces `patches` by the patches of these atoms. It is faster if they are near each other.
void build_atom_patches(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                        const BurialPatches& burial, AtomPatchScratch& scratch,
                        BuiltPatches& patches);

/// Returns the centre of the probe that touches three SAS spheres, on this side of their plane: the
/// point in which the third sphere meets the contact circle of the other two. If the centres are
/// almost collinear, the choice of the point on the circle does not matter.
Vec3 placement_center(const SasSphere& first, const SasSphere& second, const SasSphere& third,
                      int side);

}  // namespace eses::detail
