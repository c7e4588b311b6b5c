#pragma once
/// @file
/// Maximum areas of the residues of amino acids, by which relative areas are divided.

#include <optional>
#include <span>
#include <string_view>

#include "eses/atoms.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Publications of maximum areas.
enum class AreaReference {
  /// Theoretical values of Tien et al., PLoS ONE 8, e80635, 2013,
  /// doi:10.1371/journal.pone.0080635.
  tien,
  /// Miller et al., J. Mol. Biol. 196, 641, 1987, doi:10.1016/0022-2836(87)90038-6.
  miller,
  /// Rost and Sander, Proteins 20, 216, 1994, doi:10.1002/prot.340200303.
  sander,
};

/// Radius of the probe to which the maximum areas belong, in angstrom.
inline constexpr double reference_probe_radius = 1.4;

/// Returns authors, year and DOI of a reference.
std::string_view source_of(AreaReference reference);

/// Returns the maximum area on the solvent accessible surface of a residue X in a peptide
/// Gly-X-Gly, such as ALA, in square angstrom. MSE and SEC, with selenium in the place of sulfur,
/// have those of MET and CYS, and D-amino acids those of their mirror images. Nothing for names
/// other than these and those of forms in force fields, such as HIE.
std::optional<double> max_sas_area(std::string_view residue,
                                   AreaReference reference = AreaReference::tien);

/// Returns the maximum area of the residue of these atoms, all its atoms. Nothing also if they tell
/// that it is another molecule than its name, such as homoserine, HSE, which is a histidine in
/// CHARMM.
std::optional<double> max_sas_area(std::span<const AtomLabel> residue,
                                   AreaReference reference = AreaReference::tien);

}  // namespace eses
#pragma GCC visibility pop
