#include "eses/measure.hpp"

#include <cmath>
#include <stdexcept>

#include "api/arguments.hpp"
#include "surface/atom_loops.hpp"
#include "surface/measure_patches.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses {
namespace detail {

void require_valid(const MeasureOptions& options) {
  const double probe_radius = options.probe_radius.value_or(0);
  if (!(probe_radius == 0 ||
        (probe_radius >= min_probe_radius && probe_radius <= max_probe_radius)))
    throw std::invalid_argument(
        formatted("the probe radius must be 0 or between {} and {} angstrom, and is {}",
                  min_probe_radius, max_probe_radius, probe_radius));
  require_threads(options.threads);
  if (!options.ses && (options.gradients || options.cavities || !options.weights.empty()))
    throw std::invalid_argument(
        "derivatives, cavities and weighted areas need the solvent excluded surface");
}

}  // namespace detail

namespace {

void require_valid_weights(std::span<const double> weights, std::size_t atoms) {
  if (!weights.empty() && weights.size() != atoms)
    throw std::invalid_argument(
        detail::formatted("{} weights for {} atoms", weights.size(), atoms));
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isfinite(weights[i]))
      throw std::invalid_argument(
          detail::formatted("the weight of atom {} (counted from 0) is not finite", i));
}

}  // namespace

Measures measure(const Surface& surface, const MeasureOptions& options) {
  detail::require_valid(options);
  const double probe_radius = options.probe_radius.value_or(surface.probe_radius());
  const detail::Molecule& molecule = detail::SurfaceAccess::molecule(surface);
  require_valid_weights(options.weights, molecule.atoms().size());
  const int threads = detail::chosen_threads(options.threads);
  detail::MeasureSettings settings{
      probe_radius,      options.by_atom,
      options.gradients, options.weights,
      options.cavities,  detail::threads_for_atoms(molecule.atoms().size(), threads),
      options.check};
  settings.max_filled_void = surface.max_filled_void();
  Measures measures =
      options.ses ? measure_patches(molecule, settings) : measure_sas(molecule, settings);
  if (options.van_der_waals) {
    const bool is_measured = probe_radius == 0 && !settings.max_filled_void;
    const Measures bare =
        is_measured ? measures
                    : measure_sas(molecule, {.threads = settings.threads, .check = options.check});
    measures.vdw_area = bare.sas_area;
    measures.vdw_volume = bare.sas_volume;
  }
  return measures;
}

}  // namespace eses
