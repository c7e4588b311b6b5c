#include "run/exact_measures.hpp"

#include <algorithm>
#include <numbers>
#include <span>
#include <vector>

#include "surface/measure_patches.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

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
