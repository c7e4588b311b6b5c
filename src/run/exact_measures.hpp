#pragma once
/// Area and volume of the whole surface in closed form, and their comparison with a grid.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "eses/check.hpp"
#include "surface/molecule.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Area (square angstrom) and volume (cubic angstrom) of a surface.
struct ExactMeasures {
  double area = 0, volume = 0;
};

/// Measures the surface of a molecule. Cavities up to `max_filled_void` are filled, see Parameters.
ExactMeasures measure_exactly(const Molecule& molecule, double probe_radius, int threads,
                              const CheckCallback& check,
                              std::optional<double> max_filled_void = {});

/// Does the same with patches that the sweep uses later, see measure_kept_patches.
ExactMeasures measure_exactly(const std::shared_ptr<ScheduledSurface>& patches, int threads,
                              const CheckCallback& check, std::optional<double> max_filled_void);

/// Memory of the functions of this file in bytes, besides that of patches.
double exact_measure_bytes(std::size_t atoms);

/// Bounds of a volume (cubic angstrom).
struct VolumeBounds {
  double low = 0, high = 0;
};

/// Returns bounds of the total volume of the grid's cells around the inside points, for any grid
/// with this spacing (angstrom) that encloses the molecule. A cell is a cube around a grid point.
///
/// Let d(x) be the distance of x from the accessible set, and p the probe radius. A point is inside
/// if d >= p. A point and the centre of its cell are at most s = sqrt(3) / 2 spacing apart, so
/// their values of d differ by at most s. Therefore the cells of inside points cover the set d >= p
/// + s, and lie in the set d >= p - s. The set d >= t is inside the surface of a probe of radius t
/// for atoms with the same SAS spheres, and its volume is exact.
VolumeBounds bound_inside_cells(const Molecule& molecule, double probe_radius, double spacing,
                                int threads, const CheckCallback& check);

/// Compares the number of inside points of such a grid with the bounds. Returns the fault, if any.
std::optional<std::string> find_volume_fault(std::int64_t inside_points, double spacing,
                                             const VolumeBounds& bounds);

}  // namespace eses::detail
