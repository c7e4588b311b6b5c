#pragma once
/// The analytical patches of a molecule: exposed faces, accessible arcs and probe placements.
///
/// M. L. Connolly, J. Appl. Cryst. 16 (1983) 548, doi:10.1107/S0021889883010985: a convex patch per
/// exposed face of a SAS sphere, a saddle patch per accessible arc of a contact circle, a concave
/// patch per probe placement. They do not depend on the grid.

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/atom_clusters.hpp"
#include "surface/atom_patches.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// An accessible probe centre at which the probe touches three atoms.
struct ProbePlacement {
  Vec3 center;
  std::array<AtomIndex, 3> atoms{};  ///< ascending
  std::int8_t side = 1;              ///< of the atoms' plane, see PlacementKey
  /// Exactly three atoms are touched and their directions span a proper cone, which then is the
  /// normal cone of the accessible set there.
  bool is_regular = false;
};

/// Bounds of the unit vectors from an atom's centre to its exposed face.
struct FaceDirections {
  std::array<float, 3> low{1, 1, 1}, high{-1, -1, -1};

  /// Several threads may do so at a time.
  void include(const Box& directions);
  Box box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

/// The patches of one cluster, by its members; an arc belongs to the lower of its two atoms, a
/// placement to the lowest of three. Each list `..._begin` has one more element than there are
/// members.
struct ClusterPatches {
  std::vector<AtomExposure> exposure;
  std::vector<FaceDirections> face_directions;  ///< empty bounds unless exposed
  std::vector<std::uint32_t> face_begin;        ///< into face_neighbours
  std::vector<AtomIndex> face_neighbours;       ///< whose caps bound the atom's exposed face
  std::vector<std::uint32_t> arc_begin;         ///< into arcs
  std::vector<Arc> arcs;
  std::vector<std::uint32_t> placement_begin;  ///< into placements
  /// Where a probe touches four or more atoms, each triple of them has a placement there.
  std::vector<ProbePlacement> placements;
  CrowdedPatches crowded;  ///< lists some of these

  /// What the arcs of this and other clusters have told so far.
  struct Found {
    std::vector<std::uint8_t> has_arc;  ///< by member
    std::vector<PlacementKey> placements;
    std::mutex mutex;  ///< of `placements`
  } found;
};

/// The patches of one atom.
struct AtomPatches {
  const ClusterPatches* cluster = nullptr;
  std::uint32_t member = 0;

  AtomExposure exposure() const { return cluster->exposure[member]; }
  Box face_directions() const { return cluster->face_directions[member].box(); }
  std::span<const AtomIndex> face_neighbours() const {
    return part(cluster->face_neighbours, cluster->face_begin);
  }
  std::span<const Arc> arcs() const { return part(cluster->arcs, cluster->arc_begin); }
  std::span<const ProbePlacement> placements() const {
    return part(cluster->placements, cluster->placement_begin);
  }

 private:
  template <class Value>
  std::span<const Value> part(const std::vector<Value>& all,
                              const std::vector<std::uint32_t>& begin) const {
    return std::span(all).subspan(begin[member], begin[member + 1] - begin[member]);
  }
};

/// The patches of those clusters that are wanted. Each passes through four steps: it is opened, its
/// arcs are found, its patches are completed, it is closed. What happens at a point depends on the
/// completed patches of the atoms that are less than their radius and two probe radii away.
class Patches {
 public:
  /// Keeps a reference to `surface`.
  explicit Patches(const SurfaceModel& surface);

  const SurfaceModel& surface() const { return surface_; }
  const AtomClusters& clusters() const { return clusters_; }

  /// Scratch memory of a thread.
  struct Scratch {
    AtomPatchScratch atoms;
    BuiltPatches built;
  };

  /// Makes room for a cluster. What is found of clusters that are not open is dropped.
  void open(ClusterIndex cluster);
  /// Finds the arcs of an open cluster, after all clusters whose heights overlap its own have been
  /// opened, as far as they are wanted. Several threads may do so for different clusters.
  void find_arcs(ClusterIndex cluster, Scratch& scratch);
  /// Completes a cluster after the arcs of all those have been found whose heights overlap its own.
  /// Several threads may do so for different clusters.
  void complete(ClusterIndex cluster);
  /// Frees a cluster, after all clusters have been completed whose heights overlap its own.
  void close(ClusterIndex cluster);

  bool is_open(ClusterIndex cluster) const { return clusters_patches_[cluster] != nullptr; }

  /// Of an atom whose cluster has been completed.
  AtomPatches of(AtomIndex atom) const {
    const auto [cluster, member] = clusters_.place_of(atom);
    return {clusters_patches_[cluster].get(), member};
  }

 private:
  void note_arc(const Arc& arc);
  void note_on_face(AtomIndex atom, const Box& directions);
  void note_placements(std::span<const PlacementKey> keys);
  void bound_face_by_poles(AtomIndex atom);
  void place_probes(ClusterPatches& patches);

  const SurfaceModel& surface_;
  AtomClusters clusters_;
  BurialPatches burial_;
  std::vector<std::unique_ptr<ClusterPatches>> clusters_patches_;
};

}  // namespace eses::detail
