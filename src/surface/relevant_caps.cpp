#include "surface/relevant_caps.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace eses::detail {
namespace {

using std::numbers::pi;

// Caps are sorted by size in classes of this many steps of the table.
constexpr std::size_t steps_per_class = 6;
constexpr std::size_t class_count = DiscTable::steps / steps_per_class;

// The class of each step; class 0 has the largest caps.
constexpr std::array<std::uint8_t, DiscTable::steps> class_of_step = [] {
  std::array<std::uint8_t, DiscTable::steps> classes{};
  for (std::size_t step = 0; step < classes.size(); ++step)
    classes[step] = static_cast<std::uint8_t>(class_count - 1 - step / steps_per_class);
  return classes;
}();

// With more open discs, dividing them costs more than it saves.
constexpr int max_divided_discs = 24;

// Sorts the caps that meet an open disc by class. Within a class they keep their order.
void sort_by_size(RelevantCapScratch& scratch) {
  std::array<std::size_t, class_count + 1> next{};
  const std::int32_t* const steps = scratch.entries.step.data();
  const auto class_of = [&](std::uint32_t k) {
    return class_of_step[static_cast<std::size_t>(steps[k])];
  };
  for (const std::uint32_t k : scratch.meeting) ++next[class_of(k) + 1U];
  std::partial_sum(next.begin(), next.end(), next.begin());
  scratch.by_size.resize(scratch.meeting.size());
  for (const std::uint32_t k : scratch.meeting) scratch.by_size[next[class_of(k)]++] = k;
}

double outside_largest(const CapList& caps, double radius) {
  const double* const end = caps.height.data() + caps.count;
  const double cosine = *std::min_element(caps.height.data(), end) / radius;
  return 2 * pi * (1 + std::clamp(cosine, -1.0, 1.0));
}

// Finds the discs that no single cap contains, and the caps that meet them, the classes of large
// ones first.
DiscSet find_relevant(double radius, RelevantCapScratch& scratch) {
  const CapList& caps = scratch.near.caps;
  find_disc_entries(caps, radius, scratch.entries);
  DiscSet open = find_open_discs(caps.count, scratch.entries);
  if (open.is_empty()) return open;
  scratch.meeting.resize(caps.count);
  std::iota(scratch.meeting.begin(), scratch.meeting.end(), 0);
  keep_meeting_caps(scratch.entries, open, scratch.meeting);
  sort_by_size(scratch);
  if (open.count() > max_divided_discs) return open;
  remove_covered_discs(caps, scratch.by_size, radius, scratch.part_limits, open);
  keep_meeting_caps(scratch.entries, open, scratch.by_size);
  return open;
}

void append_caps(const RelevantCapScratch& scratch, AtomSection& section) {
  const std::size_t count = section.caps.count + scratch.by_size.size();
  section.caps.make_room(count);
  for (const std::uint32_t k : scratch.by_size) {
    section.caps.set(section.caps.count++, scratch.near.caps[k]);
    section.neighbours.push_back(scratch.near.neighbour(k));
  }
}

// Classifies an atom, and returns the bound of its solid angle.
double classify(const SurfaceModel& surface, AtomIndex i, RelevantCapScratch& scratch,
                AtomSection& section) {
  if (surface.molecule.is_contained(i)) return 0;
  collect_caps(surface, i, scratch.near);
  const CapList& caps = scratch.near.caps;
  if (caps.empty()) return 4 * pi;
  const double radius = surface.sas_sphere(i).radius;
  const DiscSet discs = find_relevant(radius, scratch);
  if (discs.is_empty()) return 0;
  section.open_atoms.push_back({i, discs, static_cast<std::uint32_t>(section.caps.count),
                                static_cast<std::uint32_t>(scratch.by_size.size())});
  append_caps(scratch, section);
  return outside_largest(caps, radius);
}

}  // namespace

void find_relevant_caps(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                        RelevantCapScratch& scratch, AtomSection& section) {
  section.bounds.clear();
  section.open_atoms.clear();
  section.caps.clear();
  section.neighbours.clear();
  for_each_with_neighbours(surface, atoms, scratch.near, [&](AtomIndex i) {
    section.bounds.push_back({i, classify(surface, i, scratch, section)});
  });
}

}  // namespace eses::detail
