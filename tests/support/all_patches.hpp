#pragma once
/// The patches of all atoms of a molecule at once.

#include <utility>
#include <vector>

#include "surface/patches.hpp"
#include "system/parallel.hpp"

namespace eses::detail::test {

/// Builds the patches of all atoms.
inline void build_all_patches(Patches& patches, int threads) {
  const std::uint32_t count = patches.clusters().count();
  for (std::uint32_t cluster = 0; cluster < count; ++cluster) patches.open(ClusterIndex{cluster});
  std::vector<Patches::Scratch> scratch(static_cast<std::size_t>(threads));
  parallel_for(count, threads, [&](std::int64_t cluster, int thread) {
    patches.find_arcs(static_cast<ClusterIndex>(cluster),
                      scratch[static_cast<std::size_t>(thread)]);
  });
  parallel_for(count, threads, [&](std::int64_t cluster, int) {
    patches.complete(static_cast<ClusterIndex>(cluster));
  });
}

struct AllPatches {
  SurfaceModel surface;
  Patches patches;

  AllPatches(Molecule molecule, double probe, int threads = 1)
      : surface(std::move(molecule), probe), patches(surface) {
    build_all_patches(patches, threads);
  }
  AllPatches(const AllPatches&) = delete;
  AllPatches& operator=(const AllPatches&) = delete;

  AtomPatches of(AtomIndex atom) const { return patches.of(atom); }

  /// Returns the patches by atom, in the order of their indices.
  std::vector<Arc> arcs() const {
    std::vector<Arc> all;
    for (AtomIndex i = 0; i < surface.atoms.size(); ++i)
      all.insert(all.end(), of(i).arcs().begin(), of(i).arcs().end());
    return all;
  }
  std::vector<ProbePlacement> placements() const {
    std::vector<ProbePlacement> all;
    for (AtomIndex i = 0; i < surface.atoms.size(); ++i)
      all.insert(all.end(), of(i).placements().begin(), of(i).placements().end());
    return all;
  }
};

}  // namespace eses::detail::test
