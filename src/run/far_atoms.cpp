#include "run/far_atoms.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "eses/diagnostics.hpp"
#include "eses/surface.hpp"
#include "geometry/box.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail {
namespace {

constexpr double min_examined_points = 1e8;  // of a grid that is examined
constexpr double min_near_part = 0.01;
constexpr double min_gap = 20;        // angstrom, between the centres of far atoms and the others
constexpr int max_groups = 100;       // of atoms that are far from each other
constexpr std::size_t max_shown = 5;  // far atoms in a message

// Returns an upper bound of the number of points near atoms: those of the balls that a probe
// touches, one spacing larger.
double near_points(std::span<const Atom> atoms, double probe_radius, double spacing) {
  double volume = 0;
  for (const Atom& atom : atoms)
    volume += 4 * std::numbers::pi / 3 * std::pow(atom.radius + 2 * probe_radius + spacing, 3);
  return volume / std::pow(spacing, 3);
}

// Returns the number of points of a grid around some atoms.
double points_around(std::span<const Atom> atoms, std::span<const AtomIndex> chosen,
                     const GridOptions& grid) {
  Box bounds = ball_box(atoms[chosen.front()].center, atoms[chosen.front()].radius);
  for (const AtomIndex i : chosen) {
    const Box ball = ball_box(atoms[i].center, atoms[i].radius);
    bounds.include(ball.low);
    bounds.include(ball.high);
  }
  double points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    points *=
        std::floor((bounds.high[axis] - bounds.low[axis] + 2 * grid.margin) / grid.spacing) + 1;
  return points;
}

// A gap between the centres of atoms, along an axis.
struct Gap {
  double width = 0;
  std::size_t axis = 0;
  double begin = 0;  // coordinate of the last atom before the gap
};

Gap widest_gap(std::span<const Atom> atoms, std::span<const AtomIndex> chosen) {
  Gap widest;
  std::vector<double> places(chosen.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::transform(chosen.begin(), chosen.end(), places.begin(),
                   [&](AtomIndex i) { return atoms[i].center[axis]; });
    std::sort(places.begin(), places.end());
    for (std::size_t i = 1; i < places.size(); ++i)
      if (const double width = places[i] - places[i - 1]; width > widest.width)
        widest = {width, axis, places[i - 1]};
  }
  return widest;
}

// Removes the smaller part of the atoms at the widest gap. Returns false if there is no wide gap.
bool drop_smaller_part(std::span<const Atom> atoms, std::vector<AtomIndex>& kept) {
  const Gap gap = widest_gap(atoms, kept);
  if (gap.width < min_gap) return false;
  const auto middle = std::stable_partition(kept.begin(), kept.end(), [&](AtomIndex i) {
    return atoms[i].center[gap.axis] <= gap.begin;
  });
  if (middle - kept.begin() >= kept.end() - middle)
    kept.erase(middle, kept.end());
  else
    kept.erase(kept.begin(), middle);
  return true;
}

// Returns the atoms that are left if groups far from the others are removed until the grid is not
// sparse any more.
std::vector<AtomIndex> main_group(std::span<const Atom> atoms, double probe_radius,
                                  const GridOptions& grid, std::vector<AtomIndex> kept) {
  const double near = near_points(atoms, probe_radius, grid.spacing);
  for (int i = 0; i < max_groups; ++i) {
    const double part = static_cast<double>(kept.size()) / static_cast<double>(atoms.size());
    if (part * near >= min_near_part * points_around(atoms, kept, grid)) break;
    if (!drop_smaller_part(atoms, kept)) break;
  }
  return kept;
}

// Returns a sentence with the numbers of the first far atoms, by their lines or indices.
std::string sentence(const FarAtoms& far, std::string_view kind,
                     const std::vector<std::uint64_t>& numbers) {
  const std::string points = formatted("{:.3g} points, of which at most {:.2g} % are near atoms",
                                       far.points, 100 * far.near_points / far.points);
  if (numbers.empty()) return formatted("the grid has {}", points);
  const std::size_t count = numbers.size(), shown = std::min(count, max_shown);
  const std::string without = far.points_without < 1e6 ? formatted("{:.0f}", far.points_without)
                                                       : formatted("{:.3g}", far.points_without);
  const std::string list = formatted("{}{}", fmt::join(std::span(numbers).first(shown), ", "),
                                     count > shown ? formatted(" and {} more", count - shown) : "");
  if (count == 1)
    return formatted(
        "1 atom is far from the others and stretches the grid to {}; without it, the grid has {} "
        "points: {} {}",
        points, without, kind, list);
  return formatted(
      "{} atoms are far from the others and stretch the grid to {}; without them, the grid has {} "
      "points: {} {}",
      count, points, without, kind == "line" ? "lines" : "indices", list);
}

}  // namespace

std::optional<FarAtoms> find_far_atoms(std::span<const Atom> atoms, double probe_radius,
                                       const GridOptions& grid) {
  // Invalid lengths are refused elsewhere.
  if (atoms.empty() || !(grid.spacing > 0) || !(grid.margin >= 0)) return std::nullopt;
  if (!std::isfinite(grid.spacing) || !std::isfinite(grid.margin)) return std::nullopt;
  std::vector<AtomIndex> all(atoms.size());
  std::iota(all.begin(), all.end(), AtomIndex{0});
  FarAtoms far;
  far.points = points_around(atoms, all, grid);
  if (far.points < min_examined_points) return std::nullopt;
  far.near_points = near_points(atoms, probe_radius, grid.spacing);
  if (far.near_points >= min_near_part * far.points) return std::nullopt;
  const std::vector<AtomIndex> kept = main_group(atoms, probe_radius, grid, std::move(all));
  far.points_without = points_around(atoms, kept, grid);
  std::vector<bool> is_kept(atoms.size());
  for (const AtomIndex i : kept) is_kept[i] = true;
  if (2 * kept.size() >= atoms.size())
    for (AtomIndex i = 0; i < atoms.size(); ++i)
      if (!is_kept[i]) far.atoms.push_back(i);
  return far;
}

std::optional<FarAtomsWarning> require_dense_grid(std::span<const Atom> atoms, double probe_radius,
                                                  const GridOptions& grid, std::string_view file,
                                                  std::span<const std::uint64_t> lines,
                                                  bool are_allowed, std::string_view other_way) {
  const std::optional<FarAtoms> far = find_far_atoms(atoms, probe_radius, grid);
  if (!far) return std::nullopt;
  FarAtomsWarning warning{.message = {}, .count = far->atoms.size(), .examples = {}};
  std::vector<std::uint64_t> lines_of_atoms;
  for (const AtomIndex i : far->atoms) {
    lines_of_atoms.push_back(lines[i]);
    if (warning.examples.size() < Diagnostic::max_examples)
      warning.examples.emplace_back(i, lines[i]);
  }
  warning.message = formatted("{}: {}", file, sentence(*far, "line", lines_of_atoms));
  if (!are_allowed && far->is_refused()) {
    // Without atoms far from others, the grid has its points around all of them.
    const std::string_view advice = far->points_without < far->points
                                        ? "remove atoms that do not belong to the molecule"
                                        : "use a smaller margin";
    throw HintedError(formatted("{}; {}, {}or allow far atoms", warning.message, advice, other_way),
                      {"allow_far_atoms"});
  }
  return warning;
}

}  // namespace eses::detail

namespace eses {

std::optional<FarAtoms> find_far_atoms(const Surface& surface, const GridOptions& options) {
  return detail::find_far_atoms(surface.atoms(), surface.probe_radius(), options);
}

std::vector<AtomIndex> find_stray_atoms(const Surface& surface) {
  constexpr std::size_t atoms_per_stray = 10;  // the first stray atom needs no others
  std::optional<FarAtoms> far = find_far_atoms(surface);
  if (!far || far->atoms.empty()) return {};
  const bool are_few = (far->atoms.size() - 1) * atoms_per_stray <= surface.atoms().size();
  return are_few ? std::move(far->atoms) : std::vector<AtomIndex>();
}

std::string describe(const FarAtoms& far) {
  return detail::sentence(far, "index",
                          std::vector<std::uint64_t>(far.atoms.begin(), far.atoms.end()));
}

}  // namespace eses
