#include "verify/sample.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "system/splitmix64.hpp"

namespace eses::detail::verify {
namespace {

/// Random numbers that are the same on all platforms, unlike those of the distributions in
/// <random>.
class Random {
 public:
  double below_one() { return static_cast<double>(splitmix64(count_++) >> 11) * 0x1p-53; }
  std::int64_t below(std::int64_t limit) {
    const auto number = static_cast<std::int64_t>(below_one() * static_cast<double>(limit));
    return std::min(number, limit - 1);
  }

 private:
  std::uint64_t count_ = 0;
};

/// Returns the atoms whose SAS spheres may contain points of a region. Returns no atoms if the
/// region is the whole grid, which stands for all atoms.
std::vector<std::size_t> atoms_near(const Definition& definition, const Grid& grid,
                                    const GridRegion& region) {
  std::vector<std::size_t> near;
  if (region == grid.whole()) return near;
  for (std::size_t a = 0; a < definition.atoms.size(); ++a) {
    const Atom& atom = definition.atoms[a];
    const double reach = atom.radius + definition.probe_radius;
    bool is_near = true;
    for (std::size_t q = 0; q < 3; ++q)
      is_near = is_near && atom.center[q] + reach >= grid.coordinate(q, region.begin[q]) &&
                atom.center[q] - reach <= grid.coordinate(q, region.end[q] - 1);
    if (is_near) near.push_back(a);
  }
  return near;
}

/// Draws a grid point in the common part of the box around an atom's SAS sphere and a region.
std::optional<GridIndex> draw_point_near(const Atom& atom, double sas_radius, const Grid& grid,
                                         const GridRegion& region, Random& random) {
  GridIndex point{};
  for (std::size_t q = 0; q < 3; ++q) {
    const double center = atom.center[q] - grid.origin[q];
    const auto begin = static_cast<double>(region.begin[q]);
    const auto last = static_cast<double>(region.end[q] - 1);
    const double low = std::max(begin, std::ceil((center - sas_radius) / grid.spacing));
    const double high = std::min(last, std::floor((center + sas_radius) / grid.spacing));
    if (low > high) return std::nullopt;
    const auto first = static_cast<std::int64_t>(low);
    point[q] = first + random.below(static_cast<std::int64_t>(high) - first + 1);
  }
  return point;
}

bool is_in_band_of(const Atom& atom, double probe, Vec3 x) {
  const double square = squared_norm(x - atom.center), sas_radius = atom.radius + probe;
  return square > atom.radius * atom.radius && square < sas_radius * sas_radius;
}

bool is_in_any_atom(const Definition& definition, Vec3 x) {
  bool is_in_atom = false;
  definition.cells.for_each_near(x, definition.max_radius, [&](const Atom& atom) {
    is_in_atom = is_in_atom || squared_norm(x - atom.center) <= atom.radius * atom.radius;
  });
  return is_in_atom;
}

// Returns the index of a point in the order of the grid.
std::uint64_t index_of(const Grid& grid, const GridIndex& point) {
  return static_cast<std::uint64_t>((point[2] * grid.size[1] + point[1]) * grid.size[0] + point[0]);
}

}  // namespace

std::vector<GridIndex> draw_band_points(const Definition& definition, const Grid& grid,
                                        const GridRegion& region, std::size_t count) {
  const std::vector<std::size_t> near = atoms_near(definition, grid, region);
  if (near.empty() && region != grid.whole()) return {};
  const std::size_t candidates = near.empty() ? definition.atoms.size() : near.size();
  const double probe = definition.probe_radius;
  Random random;
  std::vector<GridIndex> points;
  std::unordered_set<std::uint64_t> drawn;
  std::size_t failed_draws = 0;
  while (points.size() < count && failed_draws++ < 1000 + 4 * points.size()) {
    const auto a = static_cast<std::size_t>(random.below(static_cast<std::int64_t>(candidates)));
    const Atom& atom = definition.atoms[near.empty() ? a : near[a]];
    const auto point = draw_point_near(atom, atom.radius + probe, grid, region, random);
    if (!point) continue;
    const Vec3 x = grid.point(*point);
    if (!is_in_band_of(atom, probe, x) || is_in_any_atom(definition, x)) continue;
    if (!drawn.insert(index_of(grid, *point)).second) continue;
    points.push_back(*point);
    failed_draws = 0;
  }
  return points;
}

void CrossingSample::add(const Grid& grid, const Crossing& crossing) {
  add({splitmix64(index_of(grid, crossing.lower) * 3 + crossing.axis), crossing});
}

void CrossingSample::add(const Entry& entry) {
  const auto is_lower = [](const Entry& a, const Entry& b) { return a.rank < b.rank; };
  if (heap_.size() == capacity_) {
    if (entry.rank >= heap_.front().rank) return;
    std::pop_heap(heap_.begin(), heap_.end(), is_lower);
    heap_.pop_back();
  }
  heap_.push_back(entry);
  std::push_heap(heap_.begin(), heap_.end(), is_lower);
}

void CrossingSample::merge(const CrossingSample& other) {
  for (const Entry& entry : other.heap_) add(entry);
}

std::vector<Crossing> CrossingSample::crossings() const {
  std::vector<Entry> sorted = heap_;
  std::sort(sorted.begin(), sorted.end(),
            [](const Entry& a, const Entry& b) { return a.rank < b.rank; });
  std::vector<Crossing> crossings;
  crossings.reserve(sorted.size());
  for (const Entry& entry : sorted) crossings.push_back(entry.crossing);
  return crossings;
}

}  // namespace eses::detail::verify
