#pragma once
/// Van der Waals radii by element.

#include <optional>
#include <string_view>

namespace eses::detail {

/// Returns the radius of an element, such as `C` or `Zn`, in angstrom: the value of Bondi, else of
/// Mantina et al., else of Alvarez. Returns nothing for unknown symbols and for elements without a
/// value.
std::optional<double> bondi_radius(std::string_view element);

/// Returns the radius, in angstrom, that FreeSASA assigns to an atom of this element if its sets do
/// not name the atom.
std::optional<double> freesasa_element_radius(std::string_view element);

}  // namespace eses::detail
