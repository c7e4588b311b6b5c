#pragma once
/// Assignment of radii to the atoms of a structure.

#include <functional>
#include <optional>
#include <string_view>

#include "input/parse_structure.hpp"
#include "input/radii_set.hpp"

namespace eses::detail {

/// Returns the atoms with their radii. An atom that is not in the set gets `unknown_radius`. Labels
/// are empty unless `with_labels` is true. Calls `after_part` after each part with the atoms so
/// far. Throws Error with `file` and the names of atoms without a radius.
AtomFile assign_radii(SelectedStructure structure, const RadiiSet& radii,
                      std::optional<double> unknown_radius, bool with_labels, std::string_view file,
                      const std::function<void(AtomFile& atoms)>& after_part);

}  // namespace eses::detail
