#pragma once
/// Atoms with very many neighbours.
///
/// An atom that is much larger than the others may share patches with each of them. Examining all
/// its patches for every block, or all its caps for every circle, would take a time proportional to
/// the square of their number. A patch is near each of its atoms, so only the patches of atoms
/// nearby need to be examined for a block. For a circle, only the caps in the same parts of the
/// sphere need to be examined. For atoms with few neighbours, this would be slower.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "geometry/cap_tree.hpp"
#include "geometry/circle_arcs.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// An atom is crowded if it has more caps, or more patches of one kind, than this.
inline constexpr std::uint32_t max_uncrowded = 256;

/// The index of a patch of a crowded atom, and another atom of that patch.
struct PatchListing {
  AtomIndex atom = 0;
  std::uint32_t patch = 0;
  auto operator<=>(const PatchListing&) const = default;
};

struct ClusterPatches;

/// The patches of the crowded atoms of a cluster, ascending. PatchListing::patch is an index into
/// the list of the same name in ClusterPatches.
struct CrowdedPatches {
  std::vector<PatchListing> face_neighbours, arcs, placements;
};

/// Lists the patches of the crowded atoms of a complete cluster.
CrowdedPatches list_crowded_patches(const SurfaceModel& surface, const ClusterPatches& patches);

/// Replaces `found` by the listed patches of `atoms`, in ascending order.
void find_listed(std::span<const PatchListing> listings, std::span<const AtomIndex> atoms,
                 std::vector<std::uint32_t>& found);

/// Calls `action(patch)` for the patches [begins[member], begins[member + 1]) of an atom, in
/// ascending order. For a crowded atom, only the patches in `listed` are used.
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

/// The caps of one crowded atom. The object holds scratch memory, so each thread needs its own.
class CrowdedCaps {
 public:
  /// Replaces the caps.
  void reset(const SurfaceModel& surface, const CapList& caps, double radius);

  /// Returns whether the contact circle with the neighbour of a cap may have accessible points.
  bool has_open_circle(std::uint32_t own) const { return tree_.has_open_rim(own); }

  /// Does the same as the function accessible_arcs for the contact circle with the neighbour of cap
  /// `own`. Uses only the caps that decide about points of the circle. `cap_at(k)` returns cap `k`,
  /// or one that contains the same points of the circle.
  void accessible_arcs(const ContactCircle& circle, std::uint32_t own,
                       const std::function<Cap(std::uint32_t)>& cap_at, ArcScratch& scratch,
                       std::vector<CircleArc>& arcs, std::vector<CircleEnd>& ends);

 private:
  CapTree tree_;
  std::vector<std::uint32_t> blocking_;  // the caps that may block one circle
  CapList blocking_caps_;
};

}  // namespace eses::detail
