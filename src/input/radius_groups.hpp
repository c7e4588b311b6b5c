#pragma once
/// Tables of the built-in sets of radii.

#include <optional>
#include <span>
#include <string_view>

namespace eses::detail {

/// Atoms that have the same radius.
struct RadiusGroup {
  double radius;              ///< in angstrom
  std::string_view residues;  ///< residue names, separated by blanks; `*` for all
  /// Atom names, separated by blanks. `X*` stands for all names that begin with X.
  std::string_view atoms;
};

/// Radii of united atoms by Tsai et al. (1999), as FreeSASA extends them.
std::span<const RadiusGroup> protor_groups();

/// Radii of united atoms as pdb_to_xyzr of MSMS assigns them.
std::span<const RadiusGroup> msms_groups();

/// Returns the radius of the first group that contains the atom, or nothing if there is none.
std::optional<double> find_radius(std::span<const RadiusGroup> groups, std::string_view residue,
                                  std::string_view atom);

}  // namespace eses::detail
