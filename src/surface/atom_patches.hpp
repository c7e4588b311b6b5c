#pragma once
/// The patches to which one atom gives rise.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/burial.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

enum class AtomExposure : std::uint8_t {
  unknown,
  contained,  ///< its SAS ball lies in another one: it takes no part at all
  buried,     ///< no part of its SAS sphere is accessible
  exposed,    ///< it has an exposed face
};

/// An accessible arc of the contact circle of two atoms.
struct Arc {
  AtomIndex first = 0, second = 0;  ///< first < second
  ArcKind kind = ArcKind::full;
  Vec3 start, end;  ///< unit, from the circle's centre, counter-clockwise about first -> second
};

/// A probe placement by its atoms: ascending, and the side of their plane on which it stands, +1
/// where (second - first) x (third - first) points.
struct PlacementKey {
  std::array<AtomIndex, 3> atoms{};
  std::int8_t side = 1;
  bool is_certain = true;  ///< false if an end that is doubtful led to it, see CircleEnd

  bool is_same_place(const PlacementKey& other) const {
    return atoms == other.atoms && side == other.side;
  }
  /// Of keys for the same place, one that is not certain comes first.
  auto operator<=>(const PlacementKey&) const = default;
};

/// The patches to which some atoms give rise. Face neighbours are listed for every atom that is not
/// proved buried, as only all the arcs together tell which of them are exposed.
struct BuiltPatches {
  std::vector<AtomExposure> exposure;     ///< per atom
  std::vector<std::uint32_t> face_count;  ///< per atom
  std::vector<AtomIndex> face_neighbours;
  std::vector<std::uint32_t> arc_count;  ///< per atom
  std::vector<Arc> arcs;
  std::vector<PlacementKey> placements;  ///< every end of every arc, so with repetitions

  void clear();
};

/// Scratch memory of `build_atom_patches`, one per thread.
struct AtomPatchScratch {
  std::vector<Atom> atoms;          ///< those whose patches are built
  std::vector<AtomIndex> found;     ///< may meet one of the atoms that are looked up together
  std::vector<AtomIndex> near;      ///< those of `found` that take part
  SphereList near_spheres;          ///< the SAS spheres of `near`
  SpherePositions group_positions;  ///< in `near`, of those that may meet one of a smaller group
  SphereList group_spheres;         ///< the SAS spheres at `group_positions`
  SpherePositions neighbours;       ///< for each of `caps` the position in `group_spheres`
  CapList caps;                     ///< of one atom
  CapList kept_caps;                ///< those that matter
  std::vector<AtomIndex> kept_neighbours;
  BurialScratch burial;
  CrowdedCaps crowded;  ///< of `kept_caps`, where these are many
  ArcScratch arc;
  std::vector<CircleArc> arcs;
  std::vector<CircleEnd> ends;

  /// The atom of cap number `k`.
  AtomIndex neighbour(std::uint32_t k) const {
    const auto position = static_cast<std::size_t>(neighbours.at[k]);
    return near[static_cast<std::size_t>(group_positions.at[position])];
  }
};

/// Replaces `patches` by those of some atoms, which are best near each other.
void build_atom_patches(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                        const BurialPatches& burial, AtomPatchScratch& scratch,
                        BuiltPatches& patches);

/// Where the probe stands. The first two spheres' contact circle is met by the third; where the
/// centres are all but collinear any of the points in question is as good.
Vec3 placement_center(const SasSphere& first, const SasSphere& second, const SasSphere& third,
                      int side);

}  // namespace eses::detail
