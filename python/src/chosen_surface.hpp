#pragma once
/// The surface of the Python class.

#include <eses/eses.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace eses::python {

/// A surface with the choices of its caller. The solvent accessible surface is computed as the van
/// der Waals surface of atoms whose radii are larger by that of the probe.
struct ChosenSurface : Surface {
  /// The atoms as given, with their radii.
  std::span<const eses::Atom> given_atoms() const { return given ? *given : atoms(); }

  std::shared_ptr<const std::vector<eses::Atom>> given;  ///< if the radii of the atoms differ
  std::string kind;                                      ///< `ses`, `sas` or `vdw`
  double chosen_probe_radius;                            ///< angstrom; 0 without a probe
};

/// Throws std::invalid_argument unless this is the solvent excluded surface, which `method` needs.
/// `hint` says what to use instead.
void require_excluded(const ChosenSurface& surface, const std::string& method,
                      const std::string& hint = {});

}  // namespace eses::python
