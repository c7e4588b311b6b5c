#include "sweep/build_patches.hpp"

#include <algorithm>
#include <vector>

#include "surface/atom_patches.hpp"
#include "system/parallel.hpp"

namespace eses {
namespace {

constexpr AtomIndex atoms_per_range = 256;
constexpr int covering_frequency = 5;  // 162 directions; more cost more than they settle

// Calls body(begin, end, thread) in parallel for ranges of atoms that make up [0, count), and
// `check` before each.
template <class Body>
void for_atom_ranges(std::size_t count, int threads, const std::function<void()>& check,
                     Body&& body) {
  parallel_for(atom_range_count(count), threads, [&](std::int64_t range, int thread) {
    check();
    const auto begin = static_cast<AtomIndex>(range) * atoms_per_range;
    const auto end = static_cast<AtomIndex>(std::min<std::size_t>(begin + atoms_per_range, count));
    body(begin, end, thread);
  });
}

}  // namespace

std::int64_t atom_range_count(std::size_t atoms) {
  return static_cast<std::int64_t>((atoms + atoms_per_range - 1) / atoms_per_range);
}

void build_patches(Surface& surface, int threads, const std::function<void()>& check) {
  const BurialPatches burial(make_covering_directions(covering_frequency));
  const std::size_t count = surface.atoms.size();
  std::vector<AtomPatchScratch> scratch(static_cast<std::size_t>(threads));
  const auto of_thread = [&](int thread) -> AtomPatchScratch& {
    return scratch[static_cast<std::size_t>(thread)];
  };
  std::vector<AtomRangePatches> ranges(static_cast<std::size_t>(atom_range_count(count)));
  for_atom_ranges(count, threads, check, [&](AtomIndex begin, AtomIndex end, int thread) {
    AtomRangePatches& range = ranges[begin / atoms_per_range];
    range.begin = begin;
    range.end = end;
    build_atom_patches(surface, burial, of_thread(thread), range);
  });
  join_patches(surface, ranges, threads);
  for_atom_ranges(count, threads, check, [&](AtomIndex begin, AtomIndex end, int) {
    place_probes(surface, begin, end);
    bound_faces_by_arcs(surface, begin, end);
    bound_faces_by_poles(surface, begin, end);
  });
  merge_placements(surface);
  surface.crowded = list_crowded_patches(surface);
}

}  // namespace eses
