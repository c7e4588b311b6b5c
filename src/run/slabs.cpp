#include "run/slabs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/box.hpp"
#include "grid/region_box.hpp"
#include "output/map_writer.hpp"
#include "run/memory.hpp"
#include "surface/survey.hpp"

namespace eses::detail {
namespace {

// Seconds on one processor, measured with proteins. Only their ratios matter.
constexpr double seconds_per_atom = 14e-6;          // building the patches
constexpr double seconds_per_prepared_atom = 1e-6;  // sending the atom and building the indices
constexpr double seconds_per_crossing = 0.45e-6;
constexpr double seconds_per_crossing_text = 0.25e-6;
constexpr double seconds_per_point = 0.3e-9;
constexpr double seconds_per_point_text = 2e-9;
constexpr double seconds_per_crossing_of_mesh = 0.3e-6;
constexpr double seconds_per_point_of_map = 3e-9;

constexpr double endless = std::numeric_limits<double>::infinity();

// Maximum number of bins of planes. It limits the memory for grids with very many planes.
constexpr std::int64_t max_bins = 1 << 16;

// Returns the planes at the heights of all atoms. Planes beyond the grid continue its numbering.
PlaneRange planes_of_atoms(const Plan& plan) {
  constexpr double max_planes = 1e15;
  const auto planes_in = [&](double depth) {
    return static_cast<std::int64_t>(
        std::clamp(std::ceil(depth / plan.grid.spacing), 0.0, max_planes));
  };
  return {-planes_in(plan.cut_depths[4]), plan.grid.size[2] + planes_in(plan.cut_depths[5])};
}

// Bins of consecutive planes.
class Bins {
 public:
  Bins(const Grid& grid, const PlaneRange& planes)
      : grid_(grid), planes_(planes), per_bin_((planes_.count() + max_bins - 1) / max_bins) {}

  std::size_t count() const {
    return static_cast<std::size_t>((planes_.count() + per_bin_ - 1) / per_bin_);
  }
  std::int64_t planes_per_bin() const { return per_bin_; }
  PlaneRange planes(std::size_t begin, std::size_t end) const { return {plane(begin), plane(end)}; }
  // Returns the bin of the plane nearest to `z`, or of the nearest plane in a bin.
  std::size_t bin_of(double z) const {
    const double nearest = std::floor((z - grid_.origin.z) / grid_.spacing + 0.5);
    const auto plane = static_cast<std::int64_t>(std::clamp(
        nearest, static_cast<double>(planes_.begin), static_cast<double>(planes_.end - 1)));
    return static_cast<std::size_t>((plane - planes_.begin) / per_bin_);
  }

 private:
  std::int64_t plane(std::size_t bin) const {
    return std::min(planes_.end, planes_.begin + static_cast<std::int64_t>(bin) * per_bin_);
  }

  const Grid& grid_;
  PlaneRange planes_;
  std::int64_t per_bin_;
};

// Leaves the planes in `finished` out of the costs.
void subtract_finished(const Bins& bins, std::span<const PlaneRange> finished,
                       std::vector<double>& costs) {
  for (std::size_t b = 0; b < costs.size(); ++b) {
    const PlaneRange planes = bins.planes(b, b + 1);
    costs[b] *= static_cast<double>(plane_count(remaining(planes, finished))) /
                static_cast<double>(planes.count());
  }
}

// Returns the planes from the first to the last one of these ranges.
PlaneRange range_around(const std::vector<PlaneRange>& left) {
  return left.empty() ? PlaneRange{} : PlaneRange{left.front().begin, left.back().end};
}

std::vector<PlaneRange> cut_into_slabs(const Bins& bins, std::span<const double> costs,
                                       std::span<const PlaneRange> finished, int parts) {
  const std::vector<std::size_t> begins = cut_evenly(costs, parts);
  std::vector<PlaneRange> slabs;
  for (std::size_t part = 0; part + 1 < begins.size(); ++part)
    slabs.push_back(range_around(remaining(bins.planes(begins[part], begins[part + 1]), finished)));
  return slabs;
}

double max_cost(const Bins& bins, std::span<const double> costs,
                std::span<const PlaneRange> slabs) {
  double result = 0;
  for (const PlaneRange& slab : slabs) {
    double cost = 0;
    for (std::size_t b = 0; b < costs.size(); ++b) {
      const std::int64_t plane = bins.planes(b, b + 1).begin;
      if (plane >= slab.begin && plane < slab.end) cost += costs[b];
    }
    result = std::max(result, cost);
  }
  return result;
}

// An atom as it is sent to the processes whose slabs it influences.
struct SentAtom {
  Atom atom;
  std::uint64_t line = 0;
  FileIndex file_index{};
};
static_assert(sizeof(SentAtom) == 48);  // scripts/lib/scaling.py reads the size here

// Returns the maximum distance from a slab at which an atom influences it: the distance of Reach
// for the patches, plus the distance at which SAS spheres meet. It includes all pairs of atoms that
// give a diagnostic. For the map of ion access it is at least the ion radius.
double influence(const Atom& atom, double max_radius, double probe_radius, const Outputs& outputs) {
  constexpr double slack = 1;  // angstrom
  const double ion_radius = outputs.ion_access ? outputs.ion_access->ion_radius : 0;
  return atom.radius + slack + std::max(4 * max_radius + 6 * probe_radius, ion_radius);
}

// A slab with planes, and its interval along z. Both ends ascend from slab to slab.
struct Reached {
  std::size_t rank;
  double low, high;
};

std::vector<Reached> slabs_with_planes(const Grid& grid, std::span<const PlaneRange> slabs) {
  std::vector<Reached> reached;
  for (std::size_t rank = 0; rank < slabs.size(); ++rank) {
    const auto& [begin, end] = slabs[rank];
    // With the plane below, and with the plane above, where edges of the slab end.
    if (begin < end)
      reached.push_back({rank, grid.coordinate(2, begin - 1), grid.coordinate(2, end)});
  }
  return reached;
}

// Returns a function that decides whether a slab owns an atom. Each atom is owned by one slab.
std::function<bool(const Atom&)> ownership(const Plan& plan, std::span<const PlaneRange> slabs,
                                           std::size_t rank) {
  double low = -endless, high = endless;
  for (std::size_t other = 0; other < slabs.size(); ++other) {
    if (slabs[other].is_empty()) continue;
    if (other < rank) low = plan.grid.coordinate(2, slabs[rank].begin);
    if (other > rank) {
      high = plan.grid.coordinate(2, slabs[other].begin);
      break;
    }
  }
  return [low, high](const Atom& atom) { return atom.center.z >= low && atom.center.z < high; };
}

// Sends the atoms that this process has read, and makes its slab from the received atoms.
Slab exchange_atoms(const AtomPart& part, const Plan& plan, const Outputs& outputs,
                    std::span<const PlaneRange> slabs, int threads, const Processes& processes) {
  const double probe = plan.parameters.probe_radius;
  double max_radius = 0;
  for (const Atom& atom : part.atoms) max_radius = std::max(max_radius, atom.radius);
  processes.allreduce_max({&max_radius, 1});
  const std::vector<Reached> reached = slabs_with_planes(plan.grid, slabs);
  std::vector<std::vector<SentAtom>> to(slabs.size());
  std::vector<std::vector<mesh::GroupNumbers>> groups_to(slabs.size());
  const auto send = [&](std::size_t i, std::size_t rank) {
    to[rank].push_back({part.atoms[i], part.lines[i], static_cast<FileIndex>(part.first + i)});
    if (!part.groups.empty()) groups_to[rank].push_back(part.groups[i]);
  };
  for (std::size_t i = 0; i < part.atoms.size(); ++i) {
    const Atom& atom = part.atoms[i];
    // The first atom is sent to all slabs with planes, so that each of them has an atom.
    const bool matters_to_all = part.first + i == 0;
    const double reach = matters_to_all ? endless : influence(atom, max_radius, probe, outputs);
    auto slab = std::partition_point(reached.begin(), reached.end(), [&](const Reached& one) {
      return one.high < atom.center.z - reach;
    });
    for (; slab != reached.end() && slab->low <= atom.center.z + reach; ++slab) send(i, slab->rank);
  }
  Slab slab;
  std::vector<SentAtom> sent = processes.exchange(std::move(to));
  slab.groups = processes.exchange(std::move(groups_to));
  const auto rank = static_cast<std::size_t>(processes.rank());
  slab.planes = slabs[rank];
  processes.all_or_throw([&] {
    std::vector<Atom> atoms;
    atoms.reserve(sent.size());
    slab.atoms_in_file.reserve(sent.size());
    slab.lines.reserve(sent.size());
    for (const auto& [atom, line, file_index] : sent) {
      atoms.push_back(atom);
      slab.atoms_in_file.push_back(file_index);
      slab.lines.push_back(line);
    }
    std::vector<SentAtom>().swap(sent);
    slab.molecule = Molecule::part(std::move(atoms), ownership(plan, slabs, rank), threads);
  });
  return slab;
}

// Returns the diagnostics of all atoms. The lines are not needed any more.
FileDiagnostics take_diagnostics(Slab& slab, std::uint64_t atoms, const Processes& processes) {
  const std::vector<std::uint64_t> lines = std::exchange(slab.lines, {});
  FileDiagnostics all = gather_diagnostics(
      slab.molecule.diagnostics(),
      [&](AtomIndex slab_index) {
        return FileAtom{slab.file_indices()[slab_index], lines[slab_index]};
      },
      processes);
  // The diagnostic applies only if all radii of the molecule are small.
  std::erase_if(all.diagnostics, [atoms](const Diagnostic& diagnostic) {
    return diagnostic.kind == DiagnosticKind::small_radii && diagnostic.count < atoms;
  });
  return all;
}

// Returns the planes of `all` that are outside the region or finished.
std::vector<PlaneRange> planes_left_out(const PlaneRange& all, const Plan& plan,
                                        std::span<const PlaneRange> finished) {
  const PlaneRange within = region_planes(plan);
  std::vector<PlaneRange> left_out;
  if (within.begin > all.begin) left_out.push_back({all.begin, within.begin});
  left_out.insert(left_out.end(), finished.begin(), finished.end());
  if (within.end < all.end) left_out.push_back({within.end, all.end});
  return left_out;
}

// Cuts the planes into one slab for each process. All processes must call its functions.
class SlabCutter {
 public:
  SlabCutter(const AtomPart& part, const Plan& plan, const Outputs& outputs,
             const Processes& processes)
      : plan_(plan),
        outputs_(outputs),
        processes_(processes),
        bins_(plan.grid, planes_of_atoms(plan)),
        atoms_(bins_.count()) {
    for (const Atom& atom : part.atoms) ++atoms_[bins_.bin_of(atom.center.z)];
    processes_.add(atoms_);
    by_atoms_ = cut_into_slabs(bins_, atoms_, {}, processes_.count());
  }

  // Slabs with equal numbers of atoms. They include all atoms, also those beyond the grid.
  const std::vector<PlaneRange>& by_atoms() const { return by_atoms_; }

  // Slabs of the remaining planes with equal costs. Each process estimates the costs of `slab`,
  // which is its slab by atoms. Returns the slabs by atoms if other slabs would not save the time
  // for sending and preparing atoms again.
  std::vector<PlaneRange> by_costs(const Slab& slab, std::span<const PlaneRange> finished) const {
    const std::vector<PlaneRange> left_out =
        planes_left_out(bins_.planes(0, bins_.count()), plan_, finished);
    std::vector<double> costs = estimate_costs(slab);
    subtract_finished(bins_, left_out, costs);
    std::vector<PlaneRange> slabs = cut_into_slabs(bins_, costs, left_out, processes_.count());
    if (!left_out.empty()) return slabs;
    const double gain = max_cost(bins_, costs, by_atoms_) - max_cost(bins_, costs, slabs);
    const double loss = seconds_per_prepared_atom * max_cost(bins_, atoms_, slabs);
    return gain > loss ? slabs : by_atoms_;
  }

 private:
  // Returns the estimated seconds of each bin.
  std::vector<double> estimate_costs(const Slab& slab) const {
    std::vector<double> costs(bins_.count());
    processes_.all_or_throw([&] {
      const PlaneRange within = region_planes(plan_);
      // The planes of all bins that begin in the slab.
      const PlaneRange planes_of_bins{
          std::max(slab.planes.begin, within.begin),
          std::min(slab.planes.end + bins_.planes_per_bin() - 1, within.end)};
      if (planes_of_bins.is_empty()) return;
      const Grid& grid = plan_.grid;
      const SurfaceSurvey survey(slab.molecule, plan_.parameters.probe_radius,
                                 slab_box(plan_, planes_of_bins));
      const double point =
          seconds_per_point + (outputs_.grid ? seconds_per_point_text : 0) +
          seconds_per_point_of_map * static_cast<double>(chosen_maps(outputs_).size());
      const double crossing = seconds_per_crossing +
                              (outputs_.edges ? seconds_per_crossing_text : 0) +
                              (outputs_.mesh ? seconds_per_crossing_of_mesh : 0);
      const GridIndex size = plan_.tiling.region.size();
      for (std::size_t b = 0; b < costs.size(); ++b) {
        const PlaneRange planes = bins_.planes(b, b + 1);
        if (planes.begin < slab.planes.begin || planes.begin >= slab.planes.end) continue;
        if (planes.end <= within.begin || planes.begin >= within.end) continue;
        const double area =
            survey.area_between(grid.coordinate(2, planes.begin), grid.coordinate(2, planes.end));
        costs[b] = seconds_per_atom * atoms_[b] +
                   point * static_cast<double>(size[0] * size[1] * planes.count()) +
                   crossing * expected_crossings(area, grid.spacing);
      }
    });
    // Only one summand of each sum is not zero, so the order of summation does not matter.
    processes_.add(costs);
    return costs;
  }

  const Plan& plan_;
  const Outputs& outputs_;
  const Processes& processes_;
  Bins bins_;                  // of the planes of the grid and of atoms beyond it
  std::vector<double> atoms_;  // by bin
  std::vector<PlaneRange> by_atoms_;
};

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

std::int64_t plane_count(std::span<const PlaneRange> ranges) {
  return std::accumulate(
      ranges.begin(), ranges.end(), std::int64_t{0},
      [](std::int64_t sum, const PlaneRange& planes) { return sum + planes.count(); });
}

PlaneRange region_planes(const Plan& plan) {
  return {plan.tiling.region.begin[2], plan.tiling.region.end[2]};
}

std::pair<Slab, FileDiagnostics> make_slab(AtomPart part, const Plan& plan, const Outputs& outputs,
                                           std::span<const PlaneRange> finished, int threads,
                                           const Processes& processes) {
  const std::uint64_t atoms = part.total;
  Slab slab;
  if (processes.count() == 1) {
    slab.planes = range_around(remaining(region_planes(plan), finished));
    slab.molecule = Molecule(std::move(part.atoms), {}, threads);
    slab.groups = std::move(part.groups);
    slab.lines = std::move(part.lines);
    FileDiagnostics diagnostics = take_diagnostics(slab, atoms, processes);
    return {std::move(slab), std::move(diagnostics)};
  }
  const SlabCutter cutter(part, plan, outputs, processes);
  // These slabs include all atoms, as the diagnostics need them.
  slab = exchange_atoms(part, plan, outputs, cutter.by_atoms(), threads, processes);
  FileDiagnostics diagnostics = take_diagnostics(slab, atoms, processes);
  const std::vector<PlaneRange> slabs = cutter.by_costs(slab, finished);
  if (slabs != cutter.by_atoms()) {
    slab = {};
    slab = exchange_atoms(part, plan, outputs, slabs, threads, processes);
    slab.lines = {};
  }
  return {std::move(slab), std::move(diagnostics)};
}

Box slab_box(const Plan& plan, const PlaneRange& planes) {
  const GridRegion& region = plan.tiling.region;
  const std::int64_t begin = std::max(planes.begin - 1, region.begin[2]);
  return region_box(plan.grid, with_planes(region, {begin, planes.end}));
}

}  // namespace eses::detail
