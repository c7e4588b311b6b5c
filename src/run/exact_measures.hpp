#pragma once
/// Comparison of the volume of a grid with the exact volume.

#include <cstdint>
#include <optional>
#include <string>

#include "eses/check.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

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
