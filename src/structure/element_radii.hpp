#pragma once
/// Van der Waals radii by element.

#include <optional>
#include <string_view>

namespace eses::detail {

/// Radius of an element, such as `C` or `Zn`, in angstrom: that of Bondi, else of Mantina et al.,
/// else of Alvarez. Nothing for other symbols and elements without a value.
std::optional<double> bondi_radius(std::string_view element);

/// Radius in angstrom that FreeSASA assigns to an element where its sets do not name the atom.
std::optional<double> freesasa_element_radius(std::string_view element);

}  // namespace eses::detail
