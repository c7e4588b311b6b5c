#include "surface/placement_index.hpp"

#include <algorithm>
#include <numeric>

#include "surface/normal_cone.hpp"

namespace eses::detail {

void PlacementIndex::reset(const PatchSchedule& schedule) {
  const Patches& patches = schedule.patches();
  placements_.clear();
  centers_.clear();
  first_of_cluster_.resize(patches.clusters().count());
  for (ClusterIndex cluster = 0; cluster < patches.clusters().count(); ++cluster) {
    first_of_cluster_[cluster] = static_cast<std::uint32_t>(placements_.size());
    if (!schedule.is_complete(cluster)) continue;
    for (const ProbePlacement& placement : patches.of_cluster(cluster).placements) {
      placements_.push_back(&placement);
      centers_.push_back(placement.center);
    }
  }
  if (use_.has_search || !surface_.has_slack) tree_.reset(centers_);
  first_of_node_.resize(placements_.size());
  std::iota(first_of_node_.begin(), first_of_node_.end(), 0U);
  if (surface_.has_slack) return;
  parts_.clear();
  std::vector<std::uint32_t> node;
  for (std::uint32_t k = 0; k < first_of_node_.size(); ++k) {
    if (first_of_node_[k] != k) continue;
    find_node(k, node);
    for (const std::uint32_t other : node) first_of_node_[other] = k;
    if (use_.has_parts && node.size() > 1) divide_node(node);
  }
}

void PlacementIndex::find_node(std::uint32_t number, std::vector<std::uint32_t>& node) const {
  node.assign(1, number);
  if (surface_.has_slack) return;
  for (std::size_t k = 0; k < node.size(); ++k)
    tree_.for_each_within(centers_[node[k]], use_.same_placement, [&](std::uint32_t other) {
      if (std::find(node.begin(), node.end(), other) == node.end()) node.push_back(other);
    });
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
