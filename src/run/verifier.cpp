#include "run/verifier.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "geometry/tolerances.hpp"
#include "run/layer.hpp"
#include "surface/measure_patches.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses::detail {

using verify::CentreSearch;

namespace {

// The verification must accept every centre that the computation accepts.
static_assert(verify::possibly_accessible.shrinkage >= tolerance::accessible);

constexpr std::size_t kept_per_checked = 4;
constexpr double bytes_per_kept = 100;
constexpr double bytes_per_checked = 200;

/// A sort key of points and edges in canonical order: edges follow their lower point.
using CanonicalKey = std::array<std::int64_t, 4>;

CanonicalKey key_of(const GridIndex& point, std::int64_t kind) {
  return {point[2], point[1], point[0], kind};
}

std::string fault_of_missing(const GridIndex& point) {
  return formatted("point {} {} {} is in no block", point[0], point[1], point[2]);
}

// Returns the index of the block that owns a point.
std::int64_t owner_of(const BlockTiling& tiling, const GridIndex& point) {
  GridIndex block{};
  for (std::size_t q = 0; q < 3; ++q)
    block[q] = block_along(tiling, q, point[q] - tiling.region.begin[q]);
  return (block[2] * tiling.blocks[1] + block[1]) * tiling.blocks[0] + block[0];
}

// Chooses crossings from a sample in random order: the first `any` ones, and among the others the
// crossings nearest to another patch.
std::vector<Crossing> choose_edges(std::size_t wanted, std::size_t any,
                                   const std::vector<Crossing>& edges,
                                   std::span<const double> distances) {
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(any), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; });
  std::vector<Crossing> chosen;
  for (std::size_t c = 0; c < wanted; ++c) chosen.push_back(edges[order[c]]);
  return chosen;
}

std::function<bool(Vec3)> in_filled_cavities(const CavityMap* cavities) {
  if (cavities == nullptr) return {};
  return [cavities](Vec3 center) {
    std::vector<AtomIndex> found;
    return cavities->is_filled(cavities->locate(center, found).component);
  };
}

// Relative error of the exact volumes where a tolerance decides, see doc/measure.md.
constexpr double volume_tolerance = 1e-6;

// Returns the volume of the points at this distance (angstrom) or more from the accessible set, or
// nothing if the distance is greater than the radius of a SAS sphere.
std::optional<double> volume_beyond(const Molecule& molecule, double probe_radius, double distance,
                                    int threads, const CheckCallback& check) {
  const std::span<const Atom> given = molecule.atoms();
  std::vector<Atom> atoms(given.begin(), given.end());
  for (Atom& atom : atoms) {
    atom.radius += probe_radius - distance;
    if (atom.radius < 0) return std::nullopt;
  }
  return measure_patches(Molecule(std::move(atoms), {}, threads, check),
                         {.probe_radius = distance, .threads = threads, .check = check})
      .ses_volume;
}

}  // namespace

Verifier::Verifier(std::span<const Atom> atoms, double probe_radius, const Grid& grid,
                   const BlockTiling& tiling, int threads, std::int64_t checks,
                   const CavityMap* cavities)
    : grid_(grid),
      tiling_(tiling),
      threads_(threads),
      checks_(static_cast<std::size_t>(checks)),
      definition_(atoms, probe_radius, in_filled_cavities(cavities)),
      samples_(static_cast<std::size_t>(threads_),
               verify::CrossingSample(kept_per_checked * checks_)),
      searches_(static_cast<std::size_t>(threads_), CentreSearch(definition_)) {
  for (const GridIndex& point : draw_band_points(definition_, grid_, tiling_.region, checks_))
    points_.push_back({owner_of(tiling_, point), point, std::nullopt});
  std::stable_sort(points_.begin(), points_.end(),
                   [](const auto& a, const auto& b) { return a.block < b.block; });
}

double Verifier::memory_bytes(std::int64_t checked, int threads, double crossings) {
  const auto asked = static_cast<double>(checked);
  const double kept = std::min(kept_per_checked * asked, crossings);
  return bytes_per_checked * asked + bytes_per_kept * (threads + 1) * kept;
}

void Verifier::take_block(const BlockResult& result, std::size_t thread) {
  const std::int64_t block = owner_of(tiling_, result.block.first);
  auto point = std::lower_bound(points_.begin(), points_.end(), block,
                                [](const auto& p, std::int64_t b) { return p.block < b; });
  for (; point != points_.end() && point->block == block; ++point)
    point->is_inside = eses::detail::is_inside(result, point->index);
  for_each_crossing(grid_, result,
                    [&](const Crossing& crossing) { samples_[thread].add(grid_, crossing); });
}

Verification Verifier::check(const ProgressCallback& progress) {
  for (std::size_t s = 1; s < samples_.size(); ++s) samples_[0].merge(samples_[s]);
  std::vector<Crossing> edges = samples_[0].crossings();
  const bool is_choice = edges.size() > checks_;
  const std::size_t any = checks_ - checks_ / 2;  // verified crossings that are chosen at random
  const auto all =
      static_cast<std::int64_t>(points_.size() + edges.size() + (is_choice ? checks_ - any : 0));
  std::atomic<std::int64_t> finished = 0;
  const auto for_each_in_parallel = [&](std::size_t count, auto&& action) {
    parallel_for(static_cast<std::int64_t>(count), threads_, [&](std::int64_t index, int thread) {
      if (progress && thread == 0) progress(finished, all);
      action(static_cast<std::size_t>(index), searches_[static_cast<std::size_t>(thread)]);
      ++finished;
    });
  };
  if (is_choice) {
    std::vector<double> distances(edges.size());
    for_each_in_parallel(edges.size() - any, [&](std::size_t i, CentreSearch& search) {
      distances[any + i] = distance_to_seam(search, edges[any + i]);
    });
    edges = choose_edges(checks_, any, edges, distances);
  }

  std::vector<std::pair<CanonicalKey, std::string>> faults;
  std::mutex mutex;
  const auto report = [&](const CanonicalKey& key, std::string fault) {
    if (fault.empty()) return;
    const std::lock_guard lock(mutex);
    faults.emplace_back(key, std::move(fault));
  };
  for_each_in_parallel(points_.size(), [&](std::size_t i, CentreSearch& search) {
    const auto& [block, index, is_inside] = points_[i];
    report(key_of(index, 0),
           is_inside ? fault_of_point(search, grid_, index, *is_inside) : fault_of_missing(index));
  });
  for_each_in_parallel(edges.size(), [&](std::size_t i, CentreSearch& search) {
    report(key_of(edges[i].lower, 1 + edges[i].axis), fault_of_edge(search, grid_, edges[i]));
  });
  // Sorting makes the order of faults independent of the threads.
  std::sort(faults.begin(), faults.end());

  Verification result;
  result.points = static_cast<std::int64_t>(points_.size());
  result.edges = static_cast<std::int64_t>(edges.size());
  for (auto& [key, fault] : faults) result.faults.push_back(std::move(fault));
  return result;
}

VolumeBounds bound_inside_cells(const Molecule& molecule, double probe_radius, double spacing,
                                int threads, const CheckCallback& check) {
  const double half_diagonal = std::numbers::sqrt3 / 2 * spacing;
  const auto volume_at = [&](double distance) {
    return volume_beyond(molecule, probe_radius, distance, threads, check);
  };
  return {volume_at(probe_radius + half_diagonal).value_or(0),
          volume_at(std::max(0.0, probe_radius - half_diagonal)).value()};
}

std::optional<std::string> find_volume_fault(std::int64_t inside_points, double spacing,
                                             const VolumeBounds& bounds) {
  const double volume = static_cast<double>(inside_points) * spacing * spacing * spacing;
  const double slack = volume_tolerance * bounds.high;
  if (volume >= bounds.low - slack && volume <= bounds.high + slack) return std::nullopt;
  return formatted(
      "the cells of the inside points have a volume of {:.10g} cubic angstrom, but the exact "
      "surface requires {:.10g} to {:.10g}",
      volume, bounds.low, bounds.high);
}

}  // namespace eses::detail
