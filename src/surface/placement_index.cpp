#include "surface/placement_index.hpp"

#include <algorithm>

#include "surface/normal_cone.hpp"

namespace eses::detail {

void PlacementIndex::reset(const PatchSchedule& schedule) {
  const Patches& patches = schedule.patches();
  placements_.clear();
  centers_.clear();
  center_list_.clear();
  first_of_cluster_.clear();
  for (ClusterIndex cluster{}; cluster < patches.clusters().end(); ++cluster) {
    first_of_cluster_.push_back(end());
    if (!schedule.is_complete(cluster)) continue;
    for (const ProbePlacement& placement : patches.of_cluster(cluster).placements) {
      placements_.push_back(&placement);
      centers_.push_back(placement.center);
      center_list_.push_back({placement.center, 0});
    }
  }
  first_of_cluster_.push_back(end());
  if (use_.has_tree || !surface_.has_slack) tree_.reset(centers_);
  first_of_node_.resize(count());
  for (PlacementNumber k{}; k < end(); ++k) first_of_node_[as_number(k)] = k;
  if (!surface_.has_slack) find_nodes();
}

// Placements are visited from each other. In a large node, a placement is not visited if it is
// almost where another one has been visited, because each visit finds most of the node.
void PlacementIndex::find_nodes() {
  constexpr std::size_t max_visited = 64;
  const double same_visit = use_.same_placement / 16;
  nodes_.clear();
  parts_.clear();
  std::vector<std::uint8_t> is_found(count());
  std::vector<PlacementNumber> node;
  std::vector<Vec3> visited;
  for (PlacementNumber first{}; first < end(); ++first) {
    if (is_found[as_number(first)] != 0) continue;
    node.assign(1, first);
    visited.clear();
    is_found[as_number(first)] = 1;
    for (std::size_t n = 0; n < node.size(); ++n) {
      const Vec3 center = this->center(node[n]);
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
        node.push_back(PlacementNumber{other});
      });
    }
    if (node.size() == 1) continue;
    for (const PlacementNumber other : node) first_of_node_[as_number(other)] = first;
    if (use_.has_parts) divide_node(node);
    nodes_[first] = node;
  }
}

void PlacementIndex::find_node(PlacementNumber number, std::vector<PlacementNumber>& node) const {
  node.assign(1, number);
  const auto found = nodes_.find(first_of_node(number));
  if (surface_.has_slack || found == nodes_.end()) return;
  for (const PlacementNumber other : found->second)
    if (other != number) node.push_back(other);
}

void PlacementIndex::find_touched(std::span<const PlacementNumber> node,
                                  std::vector<AtomIndex>& touched,
                                  std::vector<Vec3>& toward) const {
  touched.clear();
  for (const PlacementNumber k : node)
    touched.insert(touched.end(), placement(k).atoms.begin(), placement(k).atoms.end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  toward.clear();
  for (const AtomIndex i : touched)
    toward.push_back(normalized(surface_.atoms[i].center - center(node.front())));
}

// The parts are the placements into which a node divides if the atoms grow, each of them much more
// than all later ones. Their cones divide the cone.
void PlacementIndex::divide_node(std::span<const PlacementNumber> node) {
  std::vector<AtomIndex> touched;
  std::vector<Vec3> toward;
  find_touched(node, touched, toward);
  std::vector<ProbePlacement>& parts = parts_[node.front()];
  for (const auto& [a, b, c] : divide_cone(toward))
    parts.push_back({center(node.front()), {touched[a], touched[b], touched[c]}});
}

PlacementParts PlacementIndex::parts_of(PlacementNumber number) const {
  const auto found = parts_.find(number);
  return found != parts_.end() ? PlacementParts(found->second)
                               : PlacementParts(&placement(number), 1);
}

}  // namespace eses::detail
