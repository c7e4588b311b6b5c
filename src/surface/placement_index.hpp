#pragma once
/// The probe placements that are at hand in a step of a sweep along z, and those that coincide.

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/cap_list.hpp"
#include "surface/patch_schedule.hpp"
#include "surface/point_tree.hpp"

namespace eses::detail {

/// The placements that touch three atoms into which a placement divides: itself, or those of
/// divide_cone. A placement that does not move has none.
using PlacementParts = std::span<const ProbePlacement>;

/// The placements of all complete clusters, by number. Placements that coincide, directly or
/// through others, are a node.
class PlacementIndex {
 public:
  /// What the index is for.
  struct Use {
    double same_placement = 0;  ///< placements within this distance coincide (angstrom)
    bool has_tree = true;       ///< whether the tree is needed
    bool has_parts = false;     ///< whether nodes are divided into parts
  };

  /// Keeps a reference to `surface`. If it has slack, no placements coincide.
  PlacementIndex(const SurfaceModel& surface, const Use& use) : surface_(surface), use_(use) {}

  /// Replaces the placements by those of all complete clusters.
  void reset(const PatchSchedule& schedule);

  const SurfaceModel& surface() const { return surface_; }
  /// Placements within this distance coincide (angstrom).
  double same_placement() const { return use_.same_placement; }
  std::span<const ProbePlacement* const> placements() const { return placements_; }
  std::span<const Vec3> centers() const { return centers_; }
  /// The centres as a list of spheres of radius 0.
  const SphereList& center_list() const { return center_list_; }
  /// By cluster: the number of its first placement.
  std::span<const std::uint32_t> first_of_cluster() const { return first_of_cluster_; }
  /// By placement: the first one of its node.
  std::span<const std::uint32_t> first_of_node() const { return first_of_node_; }
  /// Returns whether a placement is the first one of its node, which stands for all of them.
  bool is_first(std::uint32_t number) const { return first_of_node_[number] == number; }

  /// The tree of the centres, if it is needed, or the surface has no slack.
  const PointTree& tree() const { return tree_; }

  /// Replaces `node` by the placements of the node of a placement, which comes first.
  void find_node(std::uint32_t number, std::vector<std::uint32_t>& node) const;

  /// Replaces `touched` by the atoms that the placements of a node touch, in ascending order, and
  /// `toward` by the unit vectors to them.
  void find_touched(std::span<const std::uint32_t> node, std::vector<AtomIndex>& touched,
                    std::vector<Vec3>& toward) const;

  /// Returns the parts of the first placement of a node.
  PlacementParts parts_of(std::uint32_t number) const;

 private:
  void find_nodes();
  void divide_node(std::span<const std::uint32_t> node);

  const SurfaceModel& surface_;
  Use use_;
  std::vector<const ProbePlacement*> placements_;
  std::vector<Vec3> centers_;
  SphereList center_list_;
  std::vector<std::uint32_t> first_of_cluster_;
  std::vector<std::uint32_t> first_of_node_;
  // The placements of each node with several of them, and its parts, by the first placement.
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> nodes_;
  std::unordered_map<std::uint32_t, std::vector<ProbePlacement>> parts_;
  PointTree tree_;
};

}  // namespace eses::detail
