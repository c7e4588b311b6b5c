#pragma once
/// The surface of the Python class.

#include <eses/eses.hpp>
#include <string>
#include <utility>

namespace eses::python {

/// A surface with the choices of its caller. The solvent accessible surface is computed as the van
/// der Waals surface of atoms whose radii are larger by that of the probe.
struct ChosenSurface : Surface {
  ChosenSurface(const Surface& computed, Surface its_given, std::string its_kind,
                double its_probe_radius)
      : Surface(computed),
        given(std::move(its_given)),
        kind(std::move(its_kind)),
        chosen_probe_radius(its_probe_radius) {}

  Surface given;               ///< with the radii and diagnostics of the atoms as given
  std::string kind;            ///< `ses`, `sas` or `vdw`
  double chosen_probe_radius;  ///< angstrom; 0 without a probe
};

/// Throws std::invalid_argument unless this is the solvent excluded surface, which `method` needs.
/// `hint` says what to use instead.
void require_excluded(const ChosenSurface& surface, const std::string& method,
                      const std::string& hint = {});

}  // namespace eses::python
