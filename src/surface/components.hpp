#pragma once
/// The walls and components of the set of accessible probe centres.
///
/// A wall is a connected component of the boundary of that set. Faces and arcs that share an arc or
/// a placement are on the same wall. A wall encloses either a part of the set, like the wall of a
/// cavity, or a piece of the molecule. In the second case, the set continues outside of it: a ray
/// from its extreme point leads to the next wall of the same component, or to infinity.

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "eses/check.hpp"
#include "geometry/box.hpp"
#include "geometry/sphere_part.hpp"
#include "surface/patch_schedule.hpp"
#include "surface/patch_sums.hpp"
#include "surface/placement_index.hpp"
#include "surface/sphere_faces.hpp"
#include "system/disjoint_sets.hpp"
#include "system/strong_index.hpp"

namespace eses::detail {

/// Returns a box without points.
Box empty_box();

/// Returns the smallest box that contains two boxes.
Box united(const Box& a, const Box& b);

/// Returns the atoms that a probe touches, ascending.
std::vector<AtomIndex> touched_atoms(const SurfaceModel& surface, Vec3 center);

/// Index of a wall in Components::walls.
enum class WallIndex : std::uint32_t {};
/// Index of a component of the set of accessible probe centres, see Components. In contrast,
/// ComponentNumber follows the volumes of the voids.
enum class ComponentIndex : std::uint32_t {};

/// A wall of the set of accessible probe centres.
struct Wall {
  PatchSums patches;
  FaceSums faces;
  /// Integral of |x|^2 n / 2 over the faces, where x is relative to the origin. Valid only for
  /// walls of cavities.
  Vec3 moment;
  Box box = empty_box();            ///< box around the placements
  std::optional<AtomIndex> atom{};  ///< the first atom with a face on the wall
  bool encloses_atoms = false;      ///< whether the set of probe centres is outside of the wall
  ComponentIndex component{};
};

/// The components of the set of accessible probe centres. Component 0 is the outside.
class Components {
 public:
  static constexpr ComponentIndex outside{0};

  std::vector<Wall> walls;
  std::uint32_t count = 1;  ///< number of components
  /// By atom: the index of its piece of the molecule, see find_pieces.
  std::vector<std::uint32_t> piece_of_atom;
  /// By component: what to add to the sums of its walls, because only its own probes cut patches.
  std::vector<PatchSums> corrections;
  /// A placement on a wall.
  struct WallPlacement {
    Vec3 center;
    WallIndex wall{};
  };
  /// The placements that ComponentFinder::keep has kept.
  std::vector<WallPlacement> placements;
  /// Pairs of components whose voids overlap, ascending. The first one of a pair is smaller.
  std::vector<std::pair<ComponentIndex, ComponentIndex>> overlaps;

  const Wall& operator[](WallIndex wall) const { return walls[as_number(wall)]; }

  /// Returns the wall that has the face of an atom in this direction. Returns nothing if the
  /// direction is in a cap, or if rounding decides.
  std::optional<WallIndex> wall_at(AtomIndex atom, Vec3 direction) const;

  /// Returns the wall that has the arc of an atom nearest to a direction, which must be accessible
  /// up to rounding. Returns nothing if the atom has no face.
  std::optional<WallIndex> nearest_wall(AtomIndex atom, Vec3 direction) const;

  bool has_face(AtomIndex atom) const { return wall_of_atom_[atom] != no_wall; }

  /// Calls `action(wall)` once for each wall that has a face of the atom.
  template <class Action>
  void for_each_wall_of(AtomIndex atom, Action&& action) const {
    const std::uint32_t wall = wall_of_atom_[atom];
    if (wall == no_wall) return;
    if (wall < split_begin_) return action(WallIndex{wall});
    for (const WallIndex each : divided_[wall - split_begin_].walls) action(each);
  }

  /// The arcs of an atom with faces on several walls, with the walls of their faces. Null for other
  /// atoms.
  const LabelledArcs<WallIndex>* divided_arcs_of(AtomIndex atom) const {
    const std::uint32_t wall = wall_of_atom_[atom];
    if (wall == no_wall || wall < split_begin_) return nullptr;
    return &divided_[wall - split_begin_].arcs;
  }

 private:
  friend class ComponentFinder;
  static constexpr std::uint32_t no_wall = 0xffffffff;

  // An atom with faces on several walls.
  struct DividedAtom {
    LabelledArcs<WallIndex> arcs;  // with the walls of their faces
    std::vector<WallIndex> walls;  // ascending
  };

  std::vector<std::uint32_t> wall_of_atom_;  // from split_begin_: an index into `divided_`
  std::uint32_t split_begin_ = 0;
  std::vector<DividedAtom> divided_;
};

/// The patches that are known in a step of a sweep along z.
struct SweepLayer {
  const PatchSchedule& schedule;
  ClusterIndex begin, end;           ///< clusters that are measured
  ClusterIndex complete_end;         ///< all clusters before this one are complete, or freed
  const PlacementIndex& placements;  ///< with a tree
  int threads;

  /// Returns whether the patches of an atom are measured in this step.
  bool is_measured(AtomIndex atom) const {
    const ClusterIndex cluster = schedule.patches().clusters().position_of(atom).cluster;
    return cluster >= begin && cluster < end;
  }
  /// Returns whether an atom of the arc is measured in this step.
  bool is_measured(const Arc& arc) const {
    return is_measured(arc.first) || is_measured(arc.second);
  }
};

/// A concave patch that placements cut which may belong to other components.
struct SharedCut {
  DisjointSets::Element node = 0;  ///< of the placement
  Vec3 center;                     ///< relative to the origin
  std::uint32_t bound_count = 0;   ///< number of caps that bound the uncut patch
  std::vector<SphericalCap> caps;  ///< the bounds, followed by a cap for each other placement
  std::vector<DisjointSets::Element> cutters;  ///< the nodes of the other placements
  SpherePart part;                             ///< outside of all caps
};

/// Finds the components during a sweep over the patches. Each arc, each placement, and each face
/// without arcs has a node. Connected nodes are united.
class ComponentFinder {
 public:
  using Node = DisjointSets::Element;

  /// Keeps a reference to `surface`. Sums are relative to `origin`.
  ComponentFinder(const SurfaceModel& surface, Vec3 origin);

  /// Connects the patches of a layer.
  void begin_layer(const SweepLayer& layer);

  /// The root of an arc, or of a placement, of a complete cluster in the current layer. Several
  /// threads may call them.
  Node root_of_arc(ClusterIndex cluster, std::size_t arc) const {
    return sets_.root(first_node_[as_number(cluster)] + static_cast<Node>(arc));
  }
  Node root_of_placement(PlacementNumber number) const {
    return sets_.root(node_of_placement_[as_number(number)]);
  }
  /// Returns whether this root of the current layer is already connected with the outside.
  bool is_known_outside(Node root) const { return root == outside_root_; }

  /// Sums over patches of the same root.
  struct RootSums {
    Node root = 0;
    PatchSums sums;
    Box box = empty_box();  ///< box around the placements
  };
  void add(const RootSums& sums);
  void add(SharedCut cut);
  /// Keeps the placements of the current layer for Components::placements. Those that are surely
  /// connected with the outside are dropped at the end of the layer.
  void keep(Node root, Vec3 center) { kept_.push_back({center, root}); }
  /// Ends the layer. All sums have been added.
  void end_layer();

  /// The integrals over the exposed part of an atom's unit sphere.
  struct FaceIntegrals {
    double solid_angle = 0;
    Vec3 vector_area;
    Vec3 moment;  ///< sum of the terms of second_moment_term, for the atom's position
  };
  /// Returns the components. `integrals_of` is called for atoms with faces. If it is empty, the
  /// sums over faces are not valid. `check` is called between steps that take tenths of a second
  /// for a million atoms.
  Components finish(const std::function<FaceIntegrals(AtomIndex)>& integrals_of,
                    const CheckCallback& check);

 private:
  static constexpr Node no_node = 0xffffffff;

  struct KeptPlacement {
    Vec3 center;
    Node node;
  };

  Node& node_of_placement(PlacementNumber number) { return node_of_placement_[as_number(number)]; }
  void add_nodes(const SweepLayer& layer);
  void connect_arcs(const SweepLayer& layer);
  void connect_faces_of_atoms(const SweepLayer& layer);
  void merge_sums();
  void find_outside();
  void add_face(Wall& wall, AtomIndex atom, const FaceIntegrals& integrals) const;
  void add_divided_atom(AtomIndex atom, double solid_angle, const Components::DividedAtom& divided,
                        std::vector<Wall>& walls) const;
  void add_faces(const std::vector<Node>& labels,
                 const std::function<FaceIntegrals(AtomIndex)>& integrals_of,
                 Components& components);
  void find_overlaps(const std::vector<Node>& labels, Components& components);

  const SurfaceModel& surface_;
  Vec3 origin_;
  DisjointSets sets_;
  std::vector<Node> first_node_;             // by cluster: of the arcs, then of the placements
  std::vector<std::uint8_t> are_connected_;  // by cluster: whether all its arcs are connected
  std::vector<Node> node_of_atom_;           // by atom: a node of its faces
  std::vector<std::pair<AtomIndex, LabelledArcs<Node>>> divided_;
  std::vector<Node> node_of_placement_;  // by placement of the layer
  std::vector<RootSums> sums_;
  std::vector<SharedCut> cuts_;
  std::vector<KeptPlacement> kept_;
  AtomIndex lowest_atom_ = 0;    // it has a face outside
  Node outside_root_ = no_node;  // in the current layer, if known
};

}  // namespace eses::detail
