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
#include "system/strong_index.hpp"

namespace eses::detail {

/// The placements that touch three atoms into which a placement divides: itself, or those of
/// divide_cone. A placement that does not move has none.
using PlacementParts = std::span<const ProbePlacement>;

/// The number of a placement in a PlacementIndex.
enum class PlacementNumber : std::uint32_t {};

constexpr PlacementNumber operator+(PlacementNumber number, std::size_t count) {
  return static_cast<PlacementNumber>(as_number(number) + count);
}
constexpr PlacementNumber& operator++(PlacementNumber& number) { return number = number + 1; }

/// The placements of all complete clusters, by number. Those of a cluster follow each other.
/// Placements that coincide, directly or through others, are a node.
class PlacementIndex {
 public:
  /// The purposes of an index.
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
  std::size_t count() const { return placements_.size(); }
  PlacementNumber end() const { return static_cast<PlacementNumber>(count()); }
  std::span<const Vec3> centers() const { return centers_; }
  const ProbePlacement& placement(PlacementNumber number) const {
    return *placements_[as_number(number)];
  }
  Vec3 center(PlacementNumber number) const { return centers_[as_number(number)]; }
  /// The centres as a list of spheres of radius 0.
  const SphereList& center_list() const { return center_list_; }
  /// The placements of a cluster are [first_of_cluster(cluster), end_of_cluster(cluster)).
  PlacementNumber first_of_cluster(ClusterIndex cluster) const {
    return first_of_cluster_[as_number(cluster)];
  }
  PlacementNumber end_of_cluster(ClusterIndex cluster) const {
    return first_of_cluster_[as_number(cluster) + 1];
  }
  PlacementNumber first_of_node(PlacementNumber number) const {
    return first_of_node_[as_number(number)];
  }
  /// Returns whether a placement is the first one of its node, which stands for all of them.
  bool is_first(PlacementNumber number) const { return first_of_node(number) == number; }

  /// The tree of the centres, if it is needed, or the surface has no slack.
  const PointTree& tree() const { return tree_; }

  /// Replaces `node` by the placements of the node of a placement, which comes first.
  void find_node(PlacementNumber number, std::vector<PlacementNumber>& node) const;

  /// Replaces `touched` by the atoms that the placements of a node touch, in ascending order, and
  /// `toward` by the unit vectors to them.
  void find_touched(std::span<const PlacementNumber> node, std::vector<AtomIndex>& touched,
                    std::vector<Vec3>& toward) const;

  /// Returns the parts of the first placement of a node.
  PlacementParts parts_of(PlacementNumber number) const;

 private:
  void find_nodes();
  void divide_node(std::span<const PlacementNumber> node);

  const SurfaceModel& surface_;
  Use use_;
  std::vector<const ProbePlacement*> placements_;
  std::vector<Vec3> centers_;
  SphereList center_list_;
  std::vector<PlacementNumber> first_of_cluster_;  // one more than clusters
  std::vector<PlacementNumber> first_of_node_;
  // The placements of each node with several of them, and its parts, by the first placement.
  std::unordered_map<PlacementNumber, std::vector<PlacementNumber>> nodes_;
  std::unordered_map<PlacementNumber, std::vector<ProbePlacement>> parts_;
  PointTree tree_;
};

}  // namespace eses::detail
