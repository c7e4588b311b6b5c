#pragma once
/// Areas and volumes of small molecules, evaluated from the definitions in extended precision.

#include <vector>

#include "eses/atoms.hpp"
#include "eses/measure.hpp"

namespace eses::detail::test {

/// Measures the SES and the SAS: areas, volumes and the areas of the kinds of patches. All pairs
/// and triples of atoms are tried, and each accessible placement cuts each concave patch. The sums
/// have about 18 digits, so almost degenerate atoms need no tolerance. No probe may touch more than
/// three atoms.
Measures measure_by_definition(const std::vector<Atom>& atoms, double probe_radius);

}  // namespace eses::detail::test
