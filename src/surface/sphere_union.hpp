#pragma once
/// Area and volume of the union of the SAS balls: the quick way, without patches.

#include <optional>
#include <vector>

#include "eses/check.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Measures of the union of the SAS balls of a molecule. With a probe of radius 0 these are the van
/// der Waals spheres.
struct SphereUnion {
  std::vector<double> areas;    ///< accessible area of each atom (square angstrom)
  double area = 0, volume = 0;  ///< square angstrom, cubic angstrom
};

/// Measures the union of one or more balls in closed form. Cavities are outside. Returns nothing if
/// rounding may decide, or if an atom is crowded. Then the patches have to be measured.
/// doc/algorithm.md derives the method. `check` is called from time to time unless it is empty.
std::optional<SphereUnion> measure_union(const SurfaceModel& surface, int threads,
                                         const CheckCallback& check);

}  // namespace eses::detail
