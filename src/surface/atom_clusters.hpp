#pragma once
/// Clusters of atoms that are near each other, in the order of their heights.
///
/// Patches are built cluster by cluster, shortly before a sweep along z needs them, and freed
/// behind it. Atoms are sorted along z first, so that the clusters in use at a time follow the
/// cross-section of the molecule.

#include <cstdint>
#include <span>
#include <vector>

#include "surface/surface_model.hpp"

namespace eses::detail {

/// Index of a cluster, 0-based.
using ClusterIndex = std::uint32_t;

/// An interval along z (angstrom).
struct HeightRange {
  double low = 0, high = 0;
};

class AtomClusters {
 public:
  explicit AtomClusters(const SurfaceModel& surface);

  static constexpr std::uint32_t atoms_per_cluster = 128;

  ClusterIndex count() const { return static_cast<ClusterIndex>(heights_.size()); }

  /// Where an atom stands: its cluster, and its place among that cluster's atoms.
  struct Place {
    ClusterIndex cluster = 0;
    std::uint32_t member = 0;
  };
  Place place_of(AtomIndex atom) const {
    return {places_[atom] / atoms_per_cluster, places_[atom] % atoms_per_cluster};
  }

  std::span<const AtomIndex> members(ClusterIndex cluster) const;

  /// The interval that holds the SAS spheres of a cluster's atoms. Atoms whose SAS spheres meet are
  /// in clusters whose intervals overlap.
  const HeightRange& heights(ClusterIndex cluster) const { return heights_[cluster]; }

  /// The smallest n such that every cluster that begins at or below `z` is one of the first n.
  ClusterIndex count_below(double z) const;

 private:
  std::span<const AtomIndex> order_;   // atoms by cluster: the order of the cell list
  std::vector<std::uint32_t> places_;  // by atom: its place in `order_`
  std::vector<HeightRange> heights_;   // by cluster
  std::vector<double> lowest_from_;    // by cluster: the lowest height of it and all later ones
};

}  // namespace eses::detail
