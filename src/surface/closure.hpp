#pragma once
/// Checks that all patches of a surface fit together.

#include <vector>

#include "surface/components.hpp"
#include "surface/measure_sums.hpp"
#include "surface/patch_sums.hpp"

namespace eses::detail {

/// The differences of a surface from a closed one. All are rounding errors unless a patch is wrong.
struct Closure {
  /// Difference of the total curvature divided by 2 pi (Gauss-Bonnet) and the nearest even number.
  /// Concave patches count without cuts.
  double curvature = 0;
  double force = 0;   ///< largest absolute sum of the forces of SES or SAS volume, square angstrom
  double torque = 0;  ///< largest absolute sum of the torques, cubic angstrom
  double max_curvature = 0, max_force = 0, max_torque = 0;  ///< bounds of the rounding errors

  /// Returns the largest ratio of a difference and its bound.
  double excess() const;
  bool is_closed() const { return excess() <= 1; }
};

/// Returns the larger differences of two surfaces, by their ratio to the bounds.
Closure worse_of(const Closure& a, const Closure& b);

/// Returns the closure of a whole surface.
Closure closure_of(const MeasureSums& sums, const SurfaceModel& surface);

/// Returns the largest differences of any component.
Closure closure_of(const Components& components, const SurfaceModel& surface);

/// Returns the atoms whose patches do not fit together, in ascending order: those of faces that the
/// arcs do not close, and of concave patches that end where no other patch begins. `same_placement`
/// is that of the measurement.
std::vector<AtomIndex> find_open_atoms(const SurfaceModel& surface, double same_placement);

/// Throws Error, with the differences and the atoms.
[[noreturn]] void throw_open(const Closure& closure, const std::vector<AtomIndex>& atoms);

}  // namespace eses::detail
