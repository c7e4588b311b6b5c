#pragma once
/// From the atoms of a structure and a set of radii to spheres.

#include <functional>
#include <optional>
#include <string_view>

#include "structure/parse_structure.hpp"
#include "structure/radii_set.hpp"

namespace eses::detail {

/// Gives every atom its radius, or `unknown_radius` where the set has none. Labels are made if
/// `with_labels`. Calls `after_part` now and then with the atoms so far. Throws Error, which lists
/// the names of atoms without a radius, with `file`.
AtomFile assign_radii(SelectedStructure structure, const RadiiSet& radii,
                      std::optional<double> unknown_radius, bool with_labels, std::string_view file,
                      const std::function<void(AtomFile& atoms)>& after_part);

}  // namespace eses::detail
