#pragma once
/// @file
/// Areas and volumes of a surface, in closed form and without a grid.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eses/cavities.hpp"
#include "eses/check.hpp"
#include "eses/surface.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Options of measure().
struct MeasureOptions {
  /// Radius of the probe, in angstrom: 0, or `min_probe_radius` to `max_probe_radius`. The default
  /// is the radius of the surface. With 0, all surfaces are the van der Waals surface.
  std::optional<double> probe_radius = {};
  /// Whether the solvent excluded surface (SES) and the Euler number are measured, not only the
  /// solvent accessible surface (SAS). That takes about four times as long. `gradients`, `weights`
  /// and `cavities` need it.
  bool ses = true;
  /// Whether the van der Waals surface is measured.
  bool van_der_waals = false;
  /// Whether the areas are divided among the atoms.
  bool by_atom = false;
  /// Whether the derivatives are computed.
  bool gradients = false;
  /// Weights of the areas of the atoms, by atom index; none if empty. The sums of weighted areas
  /// and their derivatives are then computed, too.
  std::span<const double> weights = {};
  /// Whether the cavities and the pieces of the molecule are listed.
  bool cavities = false;
  /// Number of threads; 0 for all available processors. It does not affect the result.
  int threads = 0;
  /// Called from time to time, at least once.
  CheckCallback check = {};
};

/// Areas of the kinds of patches, in square angstrom.
struct PatchAreas {
  double convex = 0;   ///< Spherical patches where the probe touches one atom.
  double saddle = 0;   ///< Toroidal patches where the probe touches two atoms.
  double concave = 0;  ///< Spherical patches where the probe touches three or more atoms.

  /// The sum of all kinds.
  double total() const { return convex + saddle + concave; }
};

/// Areas of the atoms, by atom index, in square angstrom. A point of the surface belongs to the
/// touched atom with the smallest value of |x - center|^2 - radius^2, which is the power diagram's
/// division of space.
struct AtomAreas {
  std::vector<double> sas;      ///< Solvent accessible surface.
  std::vector<double> convex;   ///< Convex patches of the solvent excluded surface.
  std::vector<double> saddle;   ///< Saddle patches of the solvent excluded surface.
  std::vector<double> concave;  ///< Concave patches of the solvent excluded surface.

  /// Area of an atom on the solvent excluded surface; 0 if it is not measured.
  double ses(std::size_t i) const {
    return convex.empty() ? 0 : convex[i] + saddle[i] + concave[i];
  }
};

/// Derivatives of one area or volume. Lengths are in angstrom.
struct Gradient {
  std::vector<Vec3> centers;  ///< By the centre of each atom.
  std::vector<double> radii;  ///< By the radius of each atom.
  double probe = 0;           ///< By the radius of the probe.
};

/// Derivatives of areas and volumes. They are exact where areas and volumes are smooth.
struct Gradients {
  Gradient ses_area;           ///< Of Measures::ses_area.
  Gradient ses_volume;         ///< Of Measures::ses_volume.
  Gradient sas_area;           ///< Of Measures::sas_area.
  Gradient sas_volume;         ///< Of Measures::sas_volume.
  Gradient weighted_ses_area;  ///< Of Measures::weighted_ses_area; empty without weights.
  Gradient weighted_sas_area;  ///< Of Measures::weighted_sas_area; empty without weights.
  /// Whether areas and volumes are smooth: no decision depended on a tolerance, and no two SAS
  /// spheres or concave patches just touch. Otherwise, the derivatives are one-sided: those of a
  /// probe that is smaller by 1e-9 angstrom, and, where a probe touches more than three atoms,
  /// those of atoms that grow, each much more than all later ones. Spheres and patches that just
  /// touch do not meet. doc/measure.md has a table of these events.
  bool are_smooth = true;
};

/// Areas (square angstrom) and volumes (cubic angstrom) of a surface. Cavities that can contain a
/// probe are outside. Values of surfaces that are not measured are 0, and their lists are empty.
struct Measures {
  double ses_area = 0;    ///< Area of the solvent excluded surface.
  double ses_volume = 0;  ///< Volume inside the solvent excluded surface.
  PatchAreas ses_areas;   ///< The parts of `ses_area`.
  double sas_area = 0;    ///< Area of the solvent accessible surface.
  double sas_volume = 0;  ///< Volume inside the solvent accessible surface.
  double vdw_area = 0;    ///< Area of the van der Waals surface.
  double vdw_volume = 0;  ///< Volume of the van der Waals spheres.
  /// Sum of the SES areas of the atoms, each times its weight in MeasureOptions::weights. The
  /// surface is divided among the atoms as in AtomAreas.
  double weighted_ses_area = 0;
  double weighted_sas_area = 0;  ///< The same for the SAS areas.
  /// Euler number of the solvent accessible surface: the sum over its components of 2 minus twice
  /// the number of handles.
  std::int64_t euler_number = 0;
  /// The Euler number before it is rounded: the integral of the curvature, divided by 2 pi
  /// (Gauss-Bonnet). The difference shows the rounding errors.
  double total_curvature = 0;
  AtomAreas by_atom;    ///< Empty unless MeasureOptions::by_atom is set.
  Gradients gradients;  ///< Empty unless MeasureOptions::gradients is set.
  /// The cavities, in descending order of their void volumes. Empty unless MeasureOptions::cavities
  /// is set.
  std::vector<Cavity> cavities;
  /// The filled cavities, which are not in `cavities`; see SurfaceOptions::max_filled_void.
  std::vector<FilledCavity> filled_cavities;
  /// The pieces of the molecule, in descending order of their SAS volumes. Empty unless
  /// MeasureOptions::cavities is set.
  std::vector<Piece> pieces;
};

/// Measures the solvent excluded surface and the solvent accessible surface. Nothing is sampled:
/// the result has rounding errors only. Throws std::invalid_argument if an option is out of its
/// range, if the number of weights is not that of the atoms, or if something needs the SES and it
/// is not measured.
Measures measure(const Surface& surface, const MeasureOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
