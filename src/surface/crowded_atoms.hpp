#pragma once
/// Atoms with very many neighbours.
///
/// An atom that is much larger than the others may have a patch with each of them. To look at all
/// its patches for every block, or at all its caps for every circle, takes a time that grows with
/// the square of their number. Whatever happens near a patch is near each of the patch's atoms, so
/// that it is enough to look at the patches and caps that belong to atoms nearby. For other atoms,
/// that would cost more than it saves.

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// An atom with more caps, or more patches of one kind, is crowded.
inline constexpr std::uint32_t max_uncrowded = 256;

/// Index of a patch of a crowded atom, and another atom of that patch.
struct PatchListing {
  AtomIndex atom = 0;
  std::uint32_t patch = 0;
  auto operator<=>(const PatchListing&) const = default;
};

struct ClusterPatches;

/// The patches of the crowded atoms of a cluster, ascending; `patch` is an index into the list of
/// the same name in ClusterPatches.
struct CrowdedPatches {
  std::vector<PatchListing> face_neighbours, arcs, placements;
};

/// Lists the patches of the crowded atoms of a cluster that has all its patches.
CrowdedPatches list_crowded_patches(const SurfaceModel& surface, const ClusterPatches& patches);

/// Replaces `found` by the listed patches of `atoms`, ascending.
void find_listed(std::span<const PatchListing> listings, std::span<const AtomIndex> atoms,
                 std::vector<std::uint32_t>& found);

/// Calls `action(patch)` for the patches of an atom, from `begins[member]` up to the next one's, in
/// ascending order; of a crowded atom only for those that are in `listed`.
template <class Action>
void for_each_patch(std::span<const std::uint32_t> begins, std::uint32_t member,
                    std::span<const std::uint32_t> listed, Action&& action) {
  const std::uint32_t begin = begins[member], end = begins[member + 1];
  if (end - begin <= max_uncrowded) {
    for (std::uint32_t patch = begin; patch < end; ++patch) action(patch);
    return;
  }
  for (auto patch = std::lower_bound(listed.begin(), listed.end(), begin);
       patch != listed.end() && *patch < end; ++patch)
    action(*patch);
}

/// The caps of one atom, by the atom that each belongs to. Keeps scratch memory, one for each
/// thread.
class CrowdedCaps {
 public:
  /// `neighbours` has the atom of each cap. Keeps views of both.
  void reset(const CapList& caps, std::span<const AtomIndex> neighbours);

  /// As the function accessible_arcs, for the contact circle with neighbour number `own`, but looks
  /// only at the caps of atoms whose SAS spheres come near to that neighbour's, on which the circle
  /// lies. No other cap can block a point of it.
  void accessible_arcs(const SurfaceModel& surface, const ContactCircle& circle, std::uint32_t own,
                       ArcScratch& scratch, std::vector<CircleArc>& arcs,
                       std::vector<CircleEnd>& ends);

 private:
  void choose_near(const SurfaceModel& surface, AtomIndex neighbour);

  const CapList* caps_ = nullptr;
  std::span<const AtomIndex> neighbours_;
  std::vector<std::pair<AtomIndex, std::uint32_t>> numbers_;  // of the caps, by atom
  std::vector<AtomIndex> found_;
  std::vector<std::uint32_t> near_;  // numbers of caps, ascending
  CapList near_caps_;
};

}  // namespace eses::detail
