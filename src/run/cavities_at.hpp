#pragma once
/// The cavities at a place of a molecule.

#include <cstddef>
#include <span>
#include <vector>

#include "eses/cavities.hpp"
#include "eses/place.hpp"
#include "surface/measure_settings.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Returns the indices of the cavities at a place, ascending. `cavities` are those of the molecule
/// for the probe radius of the settings, whose threads and callback are used, too.
std::vector<std::size_t> cavities_at(const Molecule& molecule, std::span<const Cavity> cavities,
                                     const Place& place, const MeasureSettings& settings);

}  // namespace eses::detail
