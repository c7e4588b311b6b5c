#include "surface/atom_patches.hpp"

#include <algorithm>

namespace eses::detail {
namespace {

// Keeps the relevant caps, by size, followed by the caps that are needed only to cover.
void keep_caps(const SurfaceModel& surface, AtomIndex i, AtomPatchScratch& scratch) {
  CapList& kept = scratch.kept_caps;
  kept.make_room(scratch.burial.relevant.size() + scratch.burial.covering.size());
  kept.clear();
  scratch.kept_neighbours.clear();
  for (const auto* list : {&scratch.burial.relevant, &scratch.burial.covering})
    for (const std::uint32_t k : *list) {
      kept.set(kept.count++, scratch.near.caps[k]);
      scratch.kept_neighbours.push_back(scratch.near.neighbour(k));
    }
  const double radius = surface.sas_sphere(i).radius;
  if (scratch.kept_caps.size() > max_uncrowded)
    scratch.crowded.reset(surface, scratch.kept_caps, radius);
  else
    set_float_caps(scratch.kept_caps, radius, scratch.arc);
}

PlacementKey make_key(AtomIndex i, AtomIndex j, AtomIndex k, const CircleEnd& end) {
  PlacementKey key{{i, j, k}, end.side, !end.is_uncertain};
  const auto order = [&](std::size_t a, std::size_t b) {
    if (key.atoms[a] <= key.atoms[b]) return;
    std::swap(key.atoms[a], key.atoms[b]);
    key.side = static_cast<std::int8_t>(-key.side);
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return key;
}

// Returns kept cap `k` of atom `i` for its circle with the atom of cap `own`: another cap if these
// two neighbours are nearly equal.
Cap cap_on_circle(const SurfaceModel& surface, AtomIndex i, std::uint32_t own, std::uint32_t k,
                  const AtomPatchScratch& scratch) {
  const SasSphere second = surface.sas_sphere(scratch.kept_neighbours[own]);
  const SasSphere third = surface.sas_sphere(scratch.kept_neighbours[k]);
  if (k == own || !are_nearly_equal(second, third)) return scratch.kept_caps[k];
  Cap cap = make_cap_from_second(surface.sas_sphere(i), second, third);
  if (!surface.has_slack) cap.blocking_height = cap.height;
  return cap;
}

// Returns the kept caps of atom `i` for its circle with the atom of cap `own`.
const CapList& caps_on_circle(const SurfaceModel& surface, AtomIndex i, std::uint32_t own,
                              AtomPatchScratch& scratch) {
  if (!surface.molecule.has_nearly_equal(scratch.kept_neighbours[own])) return scratch.kept_caps;
  scratch.circle_caps.make_room(scratch.kept_caps.size());
  scratch.circle_caps.count = scratch.kept_caps.size();
  for (std::uint32_t k = 0; k < scratch.kept_caps.size(); ++k)
    scratch.circle_caps.set(k, cap_on_circle(surface, i, own, k, scratch));
  return scratch.circle_caps;
}

void add_circle(const SurfaceModel& surface, AtomIndex i, std::uint32_t own,
                AtomPatchScratch& scratch, BuiltPatches& patches) {
  const AtomIndex j = scratch.kept_neighbours[own];
  const bool is_crowded = scratch.kept_caps.size() > max_uncrowded;
  if (is_crowded && !scratch.crowded.has_open_circle(own)) return;
  const ContactCircle circle =
      make_contact_circle(surface.sas_sphere(i), surface.sas_sphere(j), scratch.kept_caps[own]);
  scratch.arcs.clear();
  scratch.ends.clear();
  if (is_crowded) {
    scratch.crowded.accessible_arcs(
        circle, own, [&](std::uint32_t k) { return cap_on_circle(surface, i, own, k, scratch); },
        scratch.arc, scratch.arcs, scratch.ends);
  } else if (!surface.molecule.has_nearly_equal(j)) {
    accessible_arcs_by_sectors(circle, scratch.kept_caps, own, scratch.arc, scratch.arcs,
                               scratch.ends);
  } else {
    accessible_arcs(circle, caps_on_circle(surface, i, own, scratch), own, scratch.arc,
                    scratch.arcs, scratch.ends);
  }
  for (const CircleArc& arc : scratch.arcs)
    patches.arcs.push_back({i, j, arc.kind, arc.start, arc.end});
  for (const CircleEnd& end : scratch.ends)
    patches.placements.push_back(make_key(i, j, scratch.kept_neighbours[end.cap], end));
}

void add_circles(const SurfaceModel& surface, AtomIndex i, AtomPatchScratch& scratch,
                 BuiltPatches& patches) {
  keep_caps(surface, i, scratch);
  for (std::uint32_t k = 0; k < scratch.burial.relevant.size(); ++k)
    if (scratch.kept_neighbours[k] > i) add_circle(surface, i, k, scratch, patches);
}

// Does the same with the caps in the order of their atoms. That order decides which of several
// uncertain ends at the same point is kept.
void add_circles_in_order(const SurfaceModel& surface, AtomIndex i, AtomPatchScratch& scratch,
                          BuiltPatches& patches) {
  std::sort(scratch.burial.relevant.begin(), scratch.burial.relevant.end(),
            [&](std::uint32_t a, std::uint32_t b) {
              return scratch.near.neighbour(a) < scratch.near.neighbour(b);
            });
  add_circles(surface, i, scratch, patches);
}

void add_exposed_atom(const SurfaceModel& surface, AtomIndex i, AtomPatchScratch& scratch,
                      BuiltPatches& patches) {
  const std::size_t first_arc = patches.arcs.size();
  const std::size_t first_placement = patches.placements.size();
  add_circles(surface, i, scratch, patches);
  if (std::all_of(patches.placements.begin() + static_cast<std::ptrdiff_t>(first_placement),
                  patches.placements.end(), [](const PlacementKey& key) { return key.is_certain; }))
    return;
  patches.arcs.resize(first_arc);
  patches.placements.resize(first_placement);
  add_circles_in_order(surface, i, scratch, patches);
}

void add_atom(const SurfaceModel& surface, const BurialPatches& burial, AtomIndex i,
              AtomPatchScratch& scratch, BuiltPatches& patches) {
  AtomExposure exposure = AtomExposure::unknown;
  const std::size_t first_arc = patches.arcs.size();
  const std::size_t first_neighbour = patches.face_neighbours.size();
  if (surface.molecule.is_contained(i)) {
    exposure = AtomExposure::contained;
  } else if (surface.needs_patches(i)) {
    collect_caps(surface, i, scratch.near);
    const double radius = surface.atoms[i].radius + surface.probe_radius;
    if (is_buried(scratch.near.caps, radius, burial, scratch.burial)) {
      exposure = AtomExposure::buried;
    } else {
      add_exposed_atom(surface, i, scratch, patches);
      if (scratch.kept_caps.empty()) exposure = AtomExposure::exposed;
      patches.face_neighbours.insert(patches.face_neighbours.end(), scratch.kept_neighbours.begin(),
                                     scratch.kept_neighbours.end());
    }
  }
  patches.exposure.push_back(exposure);
  patches.arc_count.push_back(static_cast<std::uint32_t>(patches.arcs.size() - first_arc));
  patches.face_count.push_back(
      static_cast<std::uint32_t>(patches.face_neighbours.size() - first_neighbour));
}

}  // namespace

void BuiltPatches::clear() {
  exposure.clear();
  face_count.clear();
  face_neighbours.clear();
  arc_count.clear();
  arcs.clear();
  placements.clear();
}

void build_atom_patches(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                        const BurialPatches& burial, AtomPatchScratch& scratch,
                        BuiltPatches& patches) {
  patches.clear();
  scratch.arc.min_length = surface.has_slack ? tolerance::arc_length : 0;
  for_each_with_neighbours(surface, atoms, scratch.near,
                           [&](AtomIndex i) { add_atom(surface, burial, i, scratch, patches); });
}

Vec3 placement_center(const SasSphere& first, const SasSphere& second, const SasSphere& third,
                      int side) {
  const ContactCircle circle = make_contact_circle(first, second);
  const CircleCut cut = cut_circle(circle, are_nearly_equal(second, third)
                                               ? make_cap_from_second(first, second, third)
                                               : make_cap(first, third));
  const double cosine = cut.reach > 0 ? cut.cos_half() : 1;
  const double sine = side * std::sqrt((1 - cosine) * (1 + cosine));
  return circle.center +
         circle.radius * (cosine * cut.toward + sine * cross(circle.axis, cut.toward));
}

}  // namespace eses::detail
