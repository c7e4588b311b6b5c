#pragma once
/// Areas and volumes from the patches of a molecule, in a sweep along z.

#include <span>

#include "eses/measure.hpp"
#include "surface/components.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Settings of measure_patches. See MeasureOptions.
struct MeasureSettings {
  double probe_radius = 0;
  bool by_atom = false;
  bool gradients = false;
  std::span<const double> weights = {};
  bool cavities = false;
  int threads = 1;
  CheckCallback check = {};
};

/// Measures the surface for one probe radius. Leaves the values of the van der Waals surface 0.
Measures measure_patches(const Molecule& molecule, const MeasureSettings& settings);

/// Returns the components of the set of accessible probe centres.
Components find_components(const Molecule& molecule, const MeasureSettings& settings);

}  // namespace eses::detail
