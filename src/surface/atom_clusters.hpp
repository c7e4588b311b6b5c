#pragma once
/// Clusters of neighbouring atoms, ordered along z.
///
/// Patches are built cluster by cluster, shortly before a sweep along z needs them, and freed when
/// the sweep has passed. Atoms are sorted along z first, so that the number of clusters in use at a
/// time is proportional to the cross-section of the molecule.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "surface/surface_model.hpp"
#include "system/strong_index.hpp"

namespace eses::detail {

/// Index of a cluster, 0-based.
enum class ClusterIndex : std::uint32_t {};

constexpr ClusterIndex& operator++(ClusterIndex& cluster) {
  return cluster = ClusterIndex{as_number(cluster) + 1};
}

/// An interval along z (angstrom).
struct HeightRange {
  double low = 0, high = 0;
};

/// The range that contains no height.
inline constexpr HeightRange no_heights{std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};

/// The division of all atoms into clusters of equal size.
class AtomClusters {
 public:
  explicit AtomClusters(const SurfaceModel& surface);

  /// Number of atoms in each cluster but the last one.
  static constexpr std::uint32_t atoms_per_cluster = 128;

  std::uint32_t count() const { return static_cast<std::uint32_t>(heights_.size()); }
  ClusterIndex end() const { return ClusterIndex{count()}; }

  /// The position of an atom: its cluster, and its 0-based index within the cluster.
  struct Position {
    ClusterIndex cluster{};
    std::uint32_t member = 0;
  };
  Position position_of(AtomIndex atom) const {
    return {ClusterIndex{positions_[atom] / atoms_per_cluster},
            positions_[atom] % atoms_per_cluster};
  }

  /// The atoms of a cluster.
  std::span<const AtomIndex> members(ClusterIndex cluster) const;

  /// The interval along z that the SAS spheres of a cluster's atoms span. If two SAS spheres meet,
  /// the intervals of their clusters overlap.
  const HeightRange& heights(ClusterIndex cluster) const { return heights_[as_number(cluster)]; }

  /// Returns the end of the clusters that begin at or below `z`: all later ones begin above it.
  ClusterIndex end_below(double z) const;

 private:
  std::span<const AtomIndex> order_;      // atoms by cluster: the order of the cell list
  std::vector<std::uint32_t> positions_;  // by atom: its index in `order_`
  std::vector<HeightRange> heights_;      // by cluster
  std::vector<double> min_height_from_;   // by cluster: the minimum height of it and all later ones
};

}  // namespace eses::detail
