#pragma once
/// Tables of the built-in sets of radii, in angstrom. All functions return nothing for atoms that
/// are not in the table.

#include <optional>
#include <string_view>

namespace eses::detail {

/// Returns the radius of a united atom by Tsai et al. (1999), as FreeSASA extends them.
std::optional<double> protor_radius(std::string_view residue, std::string_view atom);

/// Returns the radius of a united atom in the set of NACCESS or of Ooi et al. (1987), as FreeSASA
/// has them. The residue ANY stands for all residues.
std::optional<double> naccess_radius(std::string_view residue, std::string_view atom);
std::optional<double> oons_radius(std::string_view residue, std::string_view atom);

/// Returns the radius of a united atom other than hydrogen, as pdb_to_xyzr of MSMS assigns it.
std::optional<double> msms_radius(std::string_view residue, std::string_view atom);

/// Returns the radius by Shannon (1976) of an ion that is a residue by itself, such as NA or FE2.
std::optional<double> ionic_radius(std::string_view residue, std::string_view atom,
                                   std::string_view element);

/// Returns the van der Waals radius of an element, such as `C` or `Zn`: the value of Bondi, else of
/// Mantina et al., else of Alvarez.
std::optional<double> bondi_radius(std::string_view element);

/// Returns the radius that FreeSASA assigns to an atom of this element if its sets do not name the
/// atom.
std::optional<double> freesasa_element_radius(std::string_view element);

}  // namespace eses::detail
