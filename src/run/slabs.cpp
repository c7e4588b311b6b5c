#include "run/slabs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "grid/region_box.hpp"
#include "run/memory.hpp"

namespace eses::detail {
namespace {

// Costs in units of a grid point, measured with proteins that are written with all outputs:
// building the patches of an atom, and a crossing.
constexpr double cost_of_atom = 5000, cost_of_crossing = 300;
// The fraction of the area of a protein's atoms that is part of its surface.
constexpr double exposed_fraction = 0.1;

// Maximum number of bins of planes. It limits the memory for grids with very many planes.
constexpr std::int64_t max_bins = 1 << 16;

// Divides planes into bins of nearly equal numbers, and returns the begin of each and the end.
std::vector<std::int64_t> bins_of(const PlaneRange& planes) {
  const std::int64_t count = std::min(planes.count(), max_bins);
  std::vector<std::int64_t> begins;
  for (std::int64_t bin = 0; bin <= count; ++bin)
    begins.push_back(planes.begin + static_cast<std::int64_t>(static_cast<double>(planes.count()) *
                                                              static_cast<double>(bin) /
                                                              static_cast<double>(count)));
  return begins;
}

// Returns the costs of the bins, without those of finished planes. The cost of an atom is spread
// over its height.
std::vector<double> estimate_costs(std::span<const Atom> atoms, const Plan& plan,
                                   std::span<const std::int64_t> begins,
                                   std::span<const PlaneRange> finished) {
  const Grid& grid = plan.grid;
  const auto bin_of = [&](double z) {
    const double plane =
        std::clamp(std::round((z - grid.origin.z) / grid.spacing),
                   static_cast<double>(begins.front()), static_cast<double>(begins.back() - 1));
    return std::ranges::upper_bound(begins, static_cast<std::int64_t>(plane)) - begins.begin() - 1;
  };
  std::vector<double> costs(begins.size());  // differences of consecutive bins
  for (const auto& [center, radius] : atoms) {
    const auto begin = bin_of(center.z - radius), end = bin_of(center.z + radius) + 1;
    const double area = exposed_fraction * 4 * std::numbers::pi * radius * radius;
    const double cost = (cost_of_atom + cost_of_crossing * expected_crossings(area, grid.spacing)) /
                        static_cast<double>(end - begin);
    costs[static_cast<std::size_t>(begin)] += cost;
    costs[static_cast<std::size_t>(end)] -= cost;
  }
  costs.pop_back();
  std::partial_sum(costs.begin(), costs.end(), costs.begin());
  const GridIndex size = plan.region.size();
  for (std::size_t b = 0; b < costs.size(); ++b) {
    const PlaneRange planes{begins[b], begins[b + 1]};
    const auto all = static_cast<double>(planes.count());
    costs[b] = (std::max(0.0, costs[b]) + static_cast<double>(size[0] * size[1]) * all) *
               static_cast<double>(plane_count(remaining(planes, finished))) / all;
  }
  return costs;
}

// Returns the maximum distance from a slab at which an atom influences it: the distance of Reach
// for the patches, plus the distance at which SAS spheres meet. For the map of ion access it is at
// least the ion radius.
double influence(const Atom& atom, double max_radius, const Request& request) {
  constexpr double slack = 1;  // angstrom
  const std::optional<IonAccessMap>& ions = request.outputs.ion_access;
  return atom.radius + slack +
         std::max(4 * max_radius + 6 * request.parameters.probe_radius,
                  ions ? ions->ion_radius : 0);
}

}  // namespace

std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts) {
  std::vector<double> sums(costs.size() + 1, 0);
  std::partial_sum(costs.begin(), costs.end(), sums.begin() + 1);
  std::vector<std::size_t> begins{0};
  for (int part = 1; part < parts; ++part) {
    const double wanted = sums.back() * part / parts;
    auto cut = std::lower_bound(sums.begin(), sums.end(), wanted);
    // Chooses the nearer of the two sums around the wanted one.
    if (cut != sums.begin() && wanted - *(cut - 1) < *cut - wanted) --cut;
    begins.push_back(std::max(begins.back(), static_cast<std::size_t>(cut - sums.begin())));
  }
  begins.push_back(costs.size());
  return begins;
}

std::vector<PlaneRange> cut_into_slabs(std::span<const Atom> atoms, const Plan& plan,
                                       std::span<const PlaneRange> finished, int count) {
  const std::vector<std::int64_t> bins = bins_of(plan.planes());
  const std::vector<double> costs = estimate_costs(atoms, plan, bins, finished);
  std::vector<std::size_t> begins = cut_evenly(costs, count);
  const auto all = static_cast<std::size_t>(count);
  for (std::size_t i = 1; i < all && all <= costs.size(); ++i)
    begins[i] = std::clamp(begins[i], begins[i - 1] + 1, costs.size() - (all - i));
  std::vector<PlaneRange> slabs;
  for (std::size_t slab = 0; slab + 1 < begins.size(); ++slab)
    slabs.push_back(
        range_around(remaining({bins[begins[slab]], bins[begins[slab + 1]]}, finished)));
  return slabs;
}

Slab make_slab(std::span<const Atom> atoms, std::span<const GroupNumbers> groups,
               const Request& request, const Plan& plan, const PlaneRange& planes) {
  Slab slab;
  slab.planes = planes;
  if (planes.is_empty()) return slab;
  double max_radius = 0;
  for (const Atom& atom : atoms) max_radius = std::max(max_radius, atom.radius);
  // With the plane below, and with the plane above, where edges of the slab end.
  const double low = plan.grid.coordinate(2, planes.begin - 1);
  const double high = plan.grid.coordinate(2, planes.end);
  std::vector<Atom> near;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const Atom& atom = atoms[i];
    const double reach = influence(atom, max_radius, request);
    // The first atom is in all slabs, so that each of them has an atom.
    if (i > 0 && (atom.center.z < low - reach || atom.center.z > high + reach)) continue;
    near.push_back(atom);
    slab.atoms_in_file.push_back(static_cast<FileIndex>(i));
    if (!groups.empty()) slab.groups.push_back(groups[i]);
  }
  slab.molecule = Molecule(std::move(near), {}, request.parameters.threads);
  return slab;
}

PlaneRange range_around(std::span<const PlaneRange> ranges) {
  return ranges.empty() ? PlaneRange{} : PlaneRange{ranges.front().begin, ranges.back().end};
}

std::int64_t plane_count(std::span<const PlaneRange> ranges) {
  return std::accumulate(
      ranges.begin(), ranges.end(), std::int64_t{0},
      [](std::int64_t sum, const PlaneRange& planes) { return sum + planes.count(); });
}

Box slab_box(const Plan& plan, const PlaneRange& planes) {
  const std::int64_t begin = std::max(planes.begin - 1, plan.region.begin[2]);
  return region_box(plan.grid, with_planes(plan.region, {begin, planes.end}));
}

}  // namespace eses::detail
