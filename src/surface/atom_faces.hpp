#pragma once
/// The exposed parts of the SAS spheres of all atoms, from the arcs that bound them.

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/sphere_part.hpp"
#include "surface/arc_patch.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// The boundary term of an arc for the face of an atom.
struct FaceTerm {
  AtomIndex atom;
  SpherePart part;
  Vec3 moment;  ///< term of the second moment; zero if the arc is known to be outside
};

/// The exposed part of an atom's SAS sphere.
struct AtomFace {
  SpherePart boundary;  ///< sum of the boundary terms
  double solid_angle = 0;
  bool is_whole = false;  ///< whether the atom is exposed, as a whole sphere if there are no arcs
  bool has_arcs = false;
};

/// The faces of all atoms. Terms are added in a sweep; the solid angles are found at its end.
class AtomFaces {
 public:
  /// Keeps a reference to `surface`.
  AtomFaces(const SurfaceModel& surface, const Patches& patches, bool has_moments);

  /// Finds a large cap of each atom in the complete clusters. The arcs of other clusters have no
  /// boundary terms.
  void find_caps(const PatchSchedule& schedule, int threads);

  /// Returns the boundary terms of an arc for its two atoms. Moments are relative to `origin`.
  std::array<FaceTerm, 2> terms_of(const Arc& arc, const ArcPatch& patch, bool has_moments,
                                   Vec3 origin) const;

  void add(const FaceTerm& term);
  void set_exposed(AtomIndex atom, bool is_exposed) { faces_[atom].is_whole = is_exposed; }

  /// Finds the solid angle of a face. `found` is scratch memory.
  double measure(AtomIndex atom, std::vector<AtomIndex>& found);

  const AtomFace& operator[](AtomIndex atom) const { return faces_[atom]; }
  /// The sum of the terms of the second moment.
  Vec3 moment_of(AtomIndex atom) const { return moments_[atom]; }

 private:
  AtomIndex large_neighbour(AtomPatches patches, AtomIndex atom) const;
  Vec3 covered_direction(AtomIndex i) const {
    return normalized(surface_.atoms[neighbour_[i]].center - surface_.atoms[i].center);
  }
  bool is_filled(AtomIndex i, Vec3 direction) const;

  const SurfaceModel& surface_;
  std::vector<AtomFace> faces_;         // by atom
  std::vector<Vec3> moments_;           // by atom; empty if there are none
  std::vector<AtomIndex> neighbour_;    // by atom with a face: the one with a large cap
  std::vector<std::uint8_t> has_caps_;  // by cluster
};

}  // namespace eses::detail
