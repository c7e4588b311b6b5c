#include "surface/atom_clusters.hpp"

#include <algorithm>

namespace eses::detail {
AtomClusters::AtomClusters(const SurfaceModel& surface)
    : order_(surface.cells().order()), positions_(order_.size()) {
  for (std::uint32_t position = 0; position < order_.size(); ++position)
    positions_[order_[position]] = position;
  heights_.resize((order_.size() + atoms_per_cluster - 1) / atoms_per_cluster);
  for (ClusterIndex cluster{}; cluster < end(); ++cluster) {
    HeightRange& heights = heights_[as_number(cluster)];
    heights = no_heights;
    for (const AtomIndex i : members(cluster)) {
      const SasSphere sphere = surface.sas_sphere(i);
      heights.low = std::min(heights.low, sphere.center.z - sphere.radius);
      heights.high = std::max(heights.high, sphere.center.z + sphere.radius);
    }
  }
  min_height_from_.resize(heights_.size());
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = heights_.size(); k-- > 0;)
    min_height_from_[k] = lowest = std::min(lowest, heights_[k].low);
}

std::span<const AtomIndex> AtomClusters::members(ClusterIndex cluster) const {
  const std::size_t begin = std::size_t{as_number(cluster)} * atoms_per_cluster;
  const std::size_t end = std::min(begin + atoms_per_cluster, order_.size());
  return order_.subspan(begin, end - begin);
}

ClusterIndex AtomClusters::end_below(double z) const {
  const auto end = std::upper_bound(min_height_from_.begin(), min_height_from_.end(), z);
  return static_cast<ClusterIndex>(end - min_height_from_.begin());
}

}  // namespace eses::detail
