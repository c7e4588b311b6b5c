#include "surface/neighbour_caps.hpp"

#include <algorithm>

namespace eses::detail {
namespace {

// One search in the cell list serves a large group of atoms. Its result is then filtered for
// smaller groups.
struct GroupBounds {
  AtomIndex max_count;
  double max_distance;  // maximum distance from the first atom's centre to the others', angstrom
};
constexpr GroupBounds look_up_bounds{64, 12};
constexpr GroupBounds filter_bounds{8, 6};

// Returns the end of the group of consecutive atoms that starts at `begin`; at most `end`.
AtomIndex end_of_group(std::span<const Atom> atoms, AtomIndex begin, AtomIndex end,
                       const GroupBounds& bounds) {
  const AtomIndex last = begin + std::min(bounds.max_count, end - begin);
  const auto is_far = [&](const Atom& atom) {
    return squared_norm(atom.center - atoms[begin].center) >
           bounds.max_distance * bounds.max_distance;
  };
  AtomIndex group_end = begin + 1;
  while (group_end < last && !is_far(atoms[group_end])) ++group_end;
  return group_end;
}

double max_radius(std::span<const Atom> atoms) {
  double radius = 0;
  for (const Atom& atom : atoms) radius = std::max(radius, atom.radius);
  return radius;
}

Box box_of(std::span<const Atom> group) {
  Box box{group.front().center, group.front().center};
  for (const Atom& atom : group) box.include(atom.center);
  return box;
}

// Finds all atoms whose SAS sphere may meet that of an atom of the group. Their order decides which
// of several ends at the same point is kept. It does not depend on the other atoms, so it is the
// same in a part of the molecule.
void look_up_neighbours(const SurfaceModel& surface, std::span<const Atom> group,
                        NeighbourScratch& scratch) {
  const Box box = box_of(group);
  surface.cells().find_reaching(box, max_radius(group) + 2 * surface.probe_radius + look_up_slack,
                                scratch.found);
  SphereList& spheres = scratch.near_spheres;
  spheres.make_room(scratch.found.size());
  scratch.near.resize(scratch.found.size());
  std::size_t count = 0;
  for (const AtomIndex j : scratch.found) {
    scratch.near[count] = j;
    spheres.set(count, surface.sas_sphere(j));
    count += surface.molecule.is_contained(j) ? 0 : 1;
  }
  scratch.near.resize(count);
  spheres.count = count;
  scratch.near_floats.assign(spheres, box);
}

// Selects the found atoms whose SAS sphere may meet that of an atom of a smaller group.
void filter_neighbours(const SurfaceModel& surface, std::span<const Atom> group,
                       NeighbourScratch& scratch) {
  choose_near_box(box_of(group), max_radius(group) + surface.probe_radius, scratch.near_floats,
                  scratch.group_floats);
}

}  // namespace

void for_each_with_neighbours(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                              NeighbourScratch& scratch,
                              const std::function<void(AtomIndex)>& visit) {
  scratch.atoms.clear();
  for (const AtomIndex i : atoms) scratch.atoms.push_back(surface.atoms[i]);
  const auto count = static_cast<AtomIndex>(atoms.size());
  const auto group_of = [&](AtomIndex begin, AtomIndex end) {
    return std::span<const Atom>(scratch.atoms).subspan(begin, end - begin);
  };
  for (AtomIndex begin = 0; begin < count;) {
    const AtomIndex end = end_of_group(scratch.atoms, begin, count, look_up_bounds);
    const std::span<const AtomIndex> looked_up = atoms.subspan(begin, end - begin);
    const bool is_needed = std::any_of(looked_up.begin(), looked_up.end(),
                                       [&](AtomIndex i) { return surface.needs_patches(i); });
    if (is_needed) look_up_neighbours(surface, group_of(begin, end), scratch);
    while (begin < end) {
      const AtomIndex group_end = end_of_group(scratch.atoms, begin, end, filter_bounds);
      if (is_needed) filter_neighbours(surface, group_of(begin, group_end), scratch);
      for (; begin < group_end; ++begin) visit(atoms[begin]);
    }
  }
}

void collect_caps(const SurfaceModel& surface, AtomIndex i, NeighbourScratch& scratch) {
  const SasSphere sphere = surface.sas_sphere(i);
  const std::size_t count = find_near_sphere(sphere, scratch.group_floats, scratch.near_atom);
  make_caps(sphere, scratch.near_spheres, scratch.near_atom, count,
            surface.has_slack ? tolerance::containment : 0, scratch.neighbours, scratch.caps);
  if (!surface.has_slack) scratch.caps.blocking_height = scratch.caps.height;
}

}  // namespace eses::detail
