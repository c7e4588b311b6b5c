#include "surface/atom_slices.hpp"

#include <algorithm>
#include <cstdint>

#include "geometry/box.hpp"
#include "surface/atom_loops.hpp"

namespace eses::detail {
namespace {

// Searches near the boundary of two slices take longer, so there are few slices with many atoms.
constexpr std::size_t atoms_per_slice = std::size_t{1} << 16, max_slices = 16;
constexpr std::size_t samples_per_slice = 1024;

// Returns the centres of about `samples` atoms, evenly spread over the input order.
std::vector<Vec3> sample_centers(std::span<const Atom> atoms, std::size_t samples) {
  const std::size_t step = std::max<std::size_t>(1, atoms.size() / samples);
  std::vector<Vec3> centers;
  for (std::size_t i = 0; i < atoms.size(); i += step) centers.push_back(atoms[i].center);
  return centers;
}

std::size_t longest_axis(std::span<const Vec3> points) {
  Box box{points.front(), points.front()};
  for (const Vec3& point : points) box.include(point);
  const Vec3 sides = box.high - box.low;
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (sides[axis] > sides[longest]) longest = axis;
  return longest;
}

// Chooses axis and cuts from a sample of the atoms.
void choose_cuts(std::span<const Atom> atoms, std::size_t count, AtomSlices& slices) {
  std::vector<Vec3> centers = sample_centers(atoms, count * samples_per_slice);
  const std::size_t axis = slices.axis = longest_axis(centers);
  std::sort(centers.begin(), centers.end(),
            [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
  for (std::size_t k = 1; k < count; ++k)
    slices.cuts.push_back(centers[k * centers.size() / count][axis]);
}

}  // namespace

std::size_t slice_count(std::size_t atoms) {
  return std::clamp<std::size_t>(atoms / atoms_per_slice, 1, max_slices);
}

AtomSlices cut_into_slices(std::span<const Atom> atoms, std::size_t count, int threads) {
  AtomSlices slices;
  slices.members.resize(count);
  if (count > 1 && !atoms.empty()) choose_cuts(atoms, count, slices);
  std::vector<std::uint8_t> slice_of(atoms.size());
  for_loop_ranges(atoms.size(), threads, [&](std::size_t, AtomIndex begin, AtomIndex end) {
    for (AtomIndex i = begin; i < end; ++i) {
      const double coordinate = atoms[i].center[slices.axis];
      const auto above = std::upper_bound(slices.cuts.begin(), slices.cuts.end(), coordinate);
      slice_of[i] = static_cast<std::uint8_t>(above - slices.cuts.begin());
    }
  });
  for_each_index(count, threads, [&](std::size_t slice) {
    std::vector<AtomIndex>& members = slices.members[slice];
    members.reserve(static_cast<std::size_t>(std::count(slice_of.begin(), slice_of.end(), slice)));
    for (AtomIndex i = 0; i < slice_of.size(); ++i)
      if (slice_of[i] == slice) members.push_back(i);
  });
  return slices;
}

}  // namespace eses::detail
