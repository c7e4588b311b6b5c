#include "surface/crowded_atoms.hpp"

#include <limits>

#include "surface/patches.hpp"

namespace eses::detail {
namespace {

// The size of the parts of a sphere in which few of many caps decide (angstrom): as small as the
// slack of accessibility or, without slack, as rounding errors.
constexpr double min_part_with_slack = tolerance::accessible;
constexpr double min_part_without_slack = 1e-13;

// Lists the patches of crowded atoms. `other_atom(patch)` returns an atom of the patch other than
// the one to which the patch belongs.
template <class OtherAtom>
std::vector<PatchListing> list_patches(std::span<const std::uint32_t> begins,
                                       OtherAtom&& other_atom) {
  std::vector<PatchListing> listings;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    if (begins[i + 1] - begins[i] <= max_uncrowded) continue;
    for (std::uint32_t patch = begins[i]; patch < begins[i + 1]; ++patch)
      listings.push_back({other_atom(patch), patch});
  }
  std::sort(listings.begin(), listings.end());
  return listings;
}

}  // namespace

CrowdedPatches list_crowded_patches(const SurfaceModel& surface, const ClusterPatches& patches) {
  // The smaller of two atoms is near fewer blocks.
  const auto smaller = [&](AtomIndex a, AtomIndex b) {
    return surface.atoms[a].radius <= surface.atoms[b].radius ? a : b;
  };
  CrowdedPatches crowded;
  crowded.face_neighbours = list_patches(
      patches.face_begin, [&](std::uint32_t patch) { return patches.face_neighbours[patch]; });
  crowded.arcs = list_patches(patches.arc_begin,
                              [&](std::uint32_t patch) { return patches.arcs[patch].second; });
  crowded.placements = list_patches(patches.placement_begin, [&](std::uint32_t patch) {
    const auto& atoms = patches.placements[patch].atoms;
    return smaller(atoms[1], atoms[2]);
  });
  return crowded;
}

void find_listed(std::span<const PatchListing> listings, std::span<const AtomIndex> atoms,
                 std::vector<std::uint32_t>& found) {
  found.clear();
  if (listings.empty()) return;
  for (const AtomIndex atom : atoms) {
    auto listing = std::lower_bound(listings.begin(), listings.end(), PatchListing{atom, 0});
    for (; listing != listings.end() && listing->atom == atom; ++listing)
      found.push_back(listing->patch);
  }
  std::sort(found.begin(), found.end());
}

void CrowdedCaps::reset(const SurfaceModel& surface, const CapList& caps, double radius) {
  tree_.reset(caps, radius, surface.has_slack ? min_part_with_slack : min_part_without_slack);
}

void CrowdedCaps::accessible_arcs(const ContactCircle& circle, std::uint32_t own,
                                  const std::function<Cap(std::uint32_t)>& cap_at,
                                  ArcScratch& scratch, std::vector<CircleArc>& arcs,
                                  std::vector<CircleEnd>& ends) {
  tree_.find_blocking(own, blocking_);
  blocking_caps_.clear();
  for (const std::uint32_t k : blocking_) blocking_caps_.push_back(cap_at(k));
  const std::size_t first_end = ends.size();
  constexpr std::uint32_t not_listed = std::numeric_limits<std::uint32_t>::max();
  eses::detail::accessible_arcs(circle, blocking_caps_, not_listed, scratch, arcs, ends);
  for (std::size_t e = first_end; e < ends.size(); ++e) ends[e].cap = blocking_[ends[e].cap];
}

}  // namespace eses::detail
