#include "surface/placement_index.hpp"

#include <algorithm>
#include <numeric>

#include "surface/normal_cone.hpp"

namespace eses::detail {

void PlacementIndex::reset(const PatchSchedule& schedule) {
  const Patches& patches = schedule.patches();
  placements_.clear();
  centers_.clear();
  center_list_.clear();
  first_of_cluster_.resize(patches.clusters().count());
  for (ClusterIndex cluster{}; cluster < patches.clusters().end(); ++cluster) {
    first_of_cluster_[as_number(cluster)] = static_cast<std::uint32_t>(placements_.size());
    if (!schedule.is_complete(cluster)) continue;
    for (const ProbePlacement& placement : patches.of_cluster(cluster).placements) {
      placements_.push_back(&placement);
      centers_.push_back(placement.center);
      center_list_.push_back({placement.center, 0});
    }
  }
  if (use_.has_tree || !surface_.has_slack) tree_.reset(centers_);
  first_of_node_.resize(placements_.size());
  std::iota(first_of_node_.begin(), first_of_node_.end(), 0U);
  if (!surface_.has_slack) find_nodes();
}

// Placements are visited from each other. In a large node, a placement is not visited if it is
// almost where another one has been visited, because each visit finds most of the node.
void PlacementIndex::find_nodes() {
  constexpr std::size_t max_visited = 64;
  const double same_visit = use_.same_placement / 16;
  nodes_.clear();
  parts_.clear();
  std::vector<std::uint8_t> is_found(placements_.size());
  std::vector<std::uint32_t> node;
  std::vector<Vec3> visited;
  for (std::uint32_t k = 0; k < placements_.size(); ++k) {
    if (is_found[k] != 0) continue;
    node.assign(1, k);
    visited.clear();
    is_found[k] = 1;
    for (std::size_t n = 0; n < node.size(); ++n) {
      const Vec3 center = centers_[node[n]];
      if (node.size() > max_visited) {
        if (std::any_of(visited.begin(), visited.end(), [&](Vec3 other) {
              return squared_norm(other - center) < same_visit * same_visit;
            }))
          continue;
        visited.push_back(center);
      }
      tree_.for_each_within(center, use_.same_placement, [&](std::uint32_t other) {
        if (is_found[other] != 0) return;
        is_found[other] = 1;
        node.push_back(other);
      });
    }
    if (node.size() == 1) continue;
    for (const std::uint32_t other : node) first_of_node_[other] = k;
    if (use_.has_parts) divide_node(node);
    nodes_[k] = node;
  }
}

void PlacementIndex::find_node(std::uint32_t number, std::vector<std::uint32_t>& node) const {
  node.assign(1, number);
  const auto found = nodes_.find(first_of_node_[number]);
  if (surface_.has_slack || found == nodes_.end()) return;
  for (const std::uint32_t other : found->second)
    if (other != number) node.push_back(other);
}

void PlacementIndex::find_touched(std::span<const std::uint32_t> node,
                                  std::vector<AtomIndex>& touched,
                                  std::vector<Vec3>& toward) const {
  touched.clear();
  for (const std::uint32_t k : node)
    touched.insert(touched.end(), placements_[k]->atoms.begin(), placements_[k]->atoms.end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  toward.clear();
  for (const AtomIndex i : touched)
    toward.push_back(normalized(surface_.atoms[i].center - centers_[node.front()]));
}

// The parts are the placements into which a node divides if the atoms grow, each of them much more
// than all later ones. Their cones divide the cone.
void PlacementIndex::divide_node(std::span<const std::uint32_t> node) {
  std::vector<AtomIndex> touched;
  std::vector<Vec3> toward;
  find_touched(node, touched, toward);
  std::vector<ProbePlacement>& parts = parts_[node.front()];
  for (const auto& [a, b, c] : divide_cone(toward))
    parts.push_back({centers_[node.front()], {touched[a], touched[b], touched[c]}});
}

PlacementParts PlacementIndex::parts_of(std::uint32_t number) const {
  const auto found = parts_.find(number);
  return found != parts_.end() ? PlacementParts(found->second)
                               : PlacementParts(placements_[number], 1);
}

}  // namespace eses::detail
