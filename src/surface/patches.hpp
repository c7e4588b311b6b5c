#pragma once
/// The analytical patches of a molecule: exposed faces, accessible arcs and probe placements.
///
/// Connolly, J. Appl. Cryst. 16 (1983) 548: a convex patch per exposed face of a SAS sphere, a
/// saddle patch per accessible arc of a contact circle, a concave patch per probe placement. They
/// do not depend on the grid, are built once per atom, and are read by every block.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eses/molecule.hpp"
#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/atom_patches.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/neighbors.hpp"
#include "surface/reach.hpp"

namespace eses {

/// An accessible probe centre at which the probe touches three atoms.
struct ProbePlacement {
  Vec3 center;
  std::array<AtomIndex, 3> atoms{};  ///< ascending
  std::int8_t side = 1;              ///< of the atoms' plane, see PlacementKey
  bool is_certain = true;            ///< see PlacementKey
  /// Exactly three atoms are touched and their directions span a proper cone, which then is the
  /// normal cone of the accessible set there.
  bool is_regular = false;
  /// A placement in doubt turned out not to be accessible.
  bool is_refuted = false;
};

/// Bounds of the unit vectors from an atom's centre to its exposed face.
struct FaceDirections {
  std::array<float, 3> low{1, 1, 1}, high{-1, -1, -1};

  /// Several threads may do so at a time.
  void include(const Box& directions);
  Box box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

/// Patches by atom; an arc belongs to the lower of its two atoms, a placement to the lowest of
/// three.
struct Patches {
  std::vector<AtomExposure> exposure;           ///< per atom
  std::vector<std::uint32_t> face_begin;        ///< per atom, into face_neighbours; size atoms + 1
  std::vector<AtomIndex> face_neighbours;       ///< whose caps bound the atom's exposed face
  std::vector<FaceDirections> face_directions;  ///< per atom; empty bounds unless exposed
  std::vector<std::uint32_t> arc_begin;         ///< per atom, into arcs; size atoms + 1
  std::vector<Arc> arcs;
  std::vector<std::uint32_t> placement_begin;  ///< per atom, into placements; size atoms + 1
  std::vector<ProbePlacement> placements;
};

/// All that the blocks read.
struct Surface {
  Molecule molecule;
  std::span<const Atom> atoms;  ///< the molecule's
  double probe_radius = 0;
  /// If only a part of space is looked at: other atoms need no patches.
  std::optional<Reach> reach;
  Patches patches;
  CrowdedPatches crowded;  ///< lists some of `patches`

  bool needs_patches(AtomIndex i) const { return !reach || reach->holds(atoms[i]); }

  /// Without patches as yet.
  Surface(Molecule of, double probe);

  /// Only what happens in `box` will be asked.
  void confine_to(const Box& box) { reach = make_reach(atoms, box, probe_radius); }

  const AtomTree& tree() const { return molecule.tree(); }

  SasSphere sas_sphere(AtomIndex i) const {
    return {atoms[i].center, atoms[i].radius + probe_radius};
  }
};

/// Joins the patches of consecutive ranges of atoms, in their order.
void join_patches(Surface& surface, std::span<AtomRangePatches> ranges, int threads);

/// After join_patches, the bounds of faces of atoms [begin, end), from several threads for disjoint
/// ranges. A face has its extremes along its rim, where its atom sees arcs, ...
void bound_faces_by_arcs(Surface& surface, AtomIndex begin, AtomIndex end);
/// ... and at those poles of the sphere that are exposed.
void bound_faces_by_poles(Surface& surface, AtomIndex begin, AtomIndex end);

/// Places the probes of atoms [begin, end), after join_patches.
void place_probes(Surface& surface, AtomIndex begin, AtomIndex end);

/// Where a probe touches four or more atoms, every triple of them gives the same placement: keeps
/// that of the lowest triple. Leaves out what is refuted. After place_probes.
void merge_placements(Surface& surface);

}  // namespace eses
