#include "surface/crowded_atoms.hpp"

#include "surface/patches.hpp"

namespace eses::detail {
namespace {

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

void CrowdedCaps::reset(const CapList& caps, std::span<const AtomIndex> neighbours) {
  caps_ = &caps;
  neighbours_ = neighbours;
  numbers_.clear();
  for (std::uint32_t k = 0; k < neighbours.size(); ++k) numbers_.emplace_back(neighbours[k], k);
  std::sort(numbers_.begin(), numbers_.end());
}

void CrowdedCaps::choose_near(const SurfaceModel& surface, AtomIndex neighbour) {
  const Atom& atom = surface.atoms[neighbour];
  const double distance = atom.radius + 2 * surface.probe_radius + look_up_slack;
  surface.tree().find_reaching(atom.center, distance, found_);
  near_.clear();
  for (const AtomIndex j : found_) {
    const auto number = std::lower_bound(numbers_.begin(), numbers_.end(), std::pair(j, 0U));
    if (number != numbers_.end() && number->first == j) near_.push_back(number->second);
  }
  std::sort(near_.begin(), near_.end());
}

void CrowdedCaps::accessible_arcs(const SurfaceModel& surface, const ContactCircle& circle,
                                  std::uint32_t own, ArcScratch& scratch,
                                  std::vector<CircleArc>& arcs, std::vector<CircleEnd>& ends) {
  choose_near(surface, neighbours_[own]);
  near_caps_.clear();
  for (const std::uint32_t k : near_) near_caps_.push_back((*caps_)[k]);
  const auto own_position = std::lower_bound(near_.begin(), near_.end(), own);
  const std::size_t first_end = ends.size();
  eses::detail::accessible_arcs(circle, near_caps_,
                                static_cast<std::uint32_t>(own_position - near_.begin()), scratch,
                                arcs, ends);
  for (std::size_t e = first_end; e < ends.size(); ++e) ends[e].cap = near_[ends[e].cap];
}

}  // namespace eses::detail
