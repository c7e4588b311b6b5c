#pragma once
/// Settings of a measurement of areas and volumes.

#include <optional>
#include <span>

#include "eses/check.hpp"
#include "surface/cavity_map.hpp"

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
  /// Maximum void of the cavities that are filled (cubic angstrom); none are filled without a
  /// value.
  std::optional<double> max_filled_void = {};
  /// The only component that is not filled, by its number; only for find_cavities.
  std::optional<ComponentNumber> kept_component = {};
  bool largest_probes = true;  ///< whether to find the largest probe of each cavity

  bool has_weights() const { return !weights.empty(); }
  /// Returns whether areas are divided among the atoms.
  bool divides_areas() const { return by_atom || has_weights(); }
};

}  // namespace eses::detail
