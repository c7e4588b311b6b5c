#pragma once
/// The analytical patches of a molecule: exposed faces, accessible arcs and probe placements.
///
/// The surface has a convex patch for each exposed face of a SAS sphere, a saddle patch for each
/// accessible arc of a contact circle, and a concave patch for each probe placement (Connolly, J.
/// Appl. Cryst. 16, 548, 1983, doi:10.1107/S0021889883010985). Patches do not depend on the grid.

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/circle_arcs.hpp"
#include "geometry/patch_boxes.hpp"
#include "surface/atom_clusters.hpp"
#include "surface/atom_patches.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/surface_model.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// An accessible probe centre at which the probe touches three atoms, in angstrom.
struct ProbePlacement {
  Vec3 center;
  std::array<AtomIndex, 3> atoms{};  ///< ascending
  std::int8_t side = 1;              ///< side of the atoms' plane, see PlacementKey
  /// Whether the probe touches exactly three atoms, and the directions to them span a cone that is
  /// not degenerate. That cone is then the normal cone of the accessible set.
  bool is_regular = false;
};

/// Bounds of the unit vectors from an atom's centre to its exposed face.
struct FaceDirections {
  std::array<float, 3> low{1, 1, 1}, high{-1, -1, -1};

  /// Extends the bounds. Several threads may call it at the same time.
  void include(const Box& directions);
  /// The bounds as a box.
  Box box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

/// The patches of one cluster, by member. An arc belongs to the lower of its two atoms, a placement
/// to the lowest of three. The patches of member m are the elements [begin[m], begin[m + 1]) of a
/// list, where `begin` is the corresponding list `..._begin`.
struct ClusterPatches {
  std::vector<AtomExposure> exposure;
  std::vector<FaceDirections> face_directions;  ///< bounds are empty if the atom is not exposed
  std::vector<std::uint32_t> face_begin;        ///< indices into face_neighbours
  std::vector<AtomIndex> face_neighbours;       ///< atoms whose caps bound the exposed face
  std::vector<std::uint32_t> arc_begin;         ///< indices into arcs
  std::vector<Arc> arcs;
  std::vector<ArcBoxes> arc_boxes;             ///< of the arcs, if there are bounds
  std::vector<std::uint32_t> placement_begin;  ///< indices into placements
  /// Placements. If a probe touches more than three atoms, each triple of them has a placement.
  std::vector<ProbePlacement> placements;
  /// Whether three arcs end at each placement, and nowhere else.
  bool is_regular = true;
  CrowdedPatches crowded;  ///< index of the patches of crowded atoms

  /// Results of the arcs of this and other clusters, until the cluster is complete.
  struct Found {
    std::vector<std::uint8_t> has_arc;  ///< by member
    std::vector<PlacementKey> placements;
    std::mutex mutex;  ///< protects `placements`
  } found;
};

/// The patches of one atom.
struct AtomPatches {
  const ClusterPatches* cluster = nullptr;
  std::uint32_t member = 0;

  AtomExposure exposure() const { return cluster->exposure[member]; }
  /// Returns whether the atom was buried before any contact circle was computed: other SAS balls
  /// cover its SAS sphere with a margin.
  bool is_proved_buried() const {
    return exposure() == AtomExposure::buried && face_neighbours().empty();
  }
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

/// The patches of the clusters that are currently needed, without those of filled cavities. Each
/// cluster passes through four steps: it is opened, its arcs are found, its patches are completed,
/// and it is closed. The surface near a point x depends on the patches of atoms with |x - center| <
/// radius + 2 probe_radius.
class Patches {
 public:
  /// Keeps a reference to `surface`. Searches for patches near a block need the bounds of faces,
  /// the index of crowded atoms, and ProbePlacement::is_regular. Without `has_bounds`, they are
  /// left out.
  explicit Patches(const SurfaceModel& surface, bool has_bounds = true);

  const SurfaceModel& surface() const { return surface_; }
  const AtomClusters& clusters() const { return clusters_; }

  /// Scratch memory of a thread.
  struct alignas(thread_alignment) Scratch {
    AtomPatchScratch atoms;
    BuiltPatches built;
  };

  /// Makes room for a cluster. Patches of clusters that are not open are dropped.
  void open(ClusterIndex cluster);
  /// Finds the arcs of an open cluster. All needed clusters whose heights overlap its own must be
  /// open. Several threads may call it for different clusters.
  void find_arcs(ClusterIndex cluster, Scratch& scratch);
  /// Completes a cluster. The arcs of all needed clusters whose heights overlap its own must have
  /// been found. Several threads may call it for different clusters.
  void complete(ClusterIndex cluster);
  /// Drops the patches of filled cavities from a cluster that was complete before they were filled.
  void drop_filled(ClusterIndex cluster);
  /// Frees a cluster. All needed clusters whose heights overlap its own must be complete.
  void close(ClusterIndex cluster);

  bool is_open(ClusterIndex cluster) const {
    return clusters_patches_[as_number(cluster)] != nullptr;
  }

  /// Returns the patches of a complete cluster.
  const ClusterPatches& of_cluster(ClusterIndex cluster) const {
    return *clusters_patches_[as_number(cluster)];
  }
  /// Returns the patches of an atom whose cluster is complete.
  AtomPatches of(AtomIndex atom) const {
    const auto [cluster, member] = clusters_.position_of(atom);
    return {clusters_patches_[as_number(cluster)].get(), member};
  }

 private:
  ClusterPatches& patches_of(ClusterIndex cluster) {
    return *clusters_patches_[as_number(cluster)];
  }
  void record_arc(const Arc& arc, ClusterPatches& patches);
  void mark_exposed(AtomIndex atom);
  void extend_face(AtomIndex atom, const Box& directions);
  void record_placements(std::span<const PlacementKey> keys);
  void extend_face_to_poles(AtomIndex atom);
  void place_probes(ClusterPatches& patches);
  void drop_filled_patches(std::span<const AtomIndex> members, ClusterPatches& patches) const;

  const SurfaceModel& surface_;
  bool has_bounds_;
  AtomClusters clusters_;
  const BurialPatches& burial_;
  std::vector<std::unique_ptr<ClusterPatches>> clusters_patches_;
};

}  // namespace eses::detail
