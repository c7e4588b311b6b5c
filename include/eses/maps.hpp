#pragma once
/// @file
/// Maps for finite-difference Poisson-Boltzmann solvers, in memory.
///
/// The functions throw as described at the top of compute.hpp, VerificationError if
/// RunOptions::verify finds faults, and what a callback throws. Each of them computes the surface
/// on the grid, in the time of compute.

#include <array>
#include <cstdint>
#include <vector>

#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "eses/run_options.hpp"
#include "eses/surface.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Choices of compute_dielectric, with the defaults of DielectricMaps: 2 and 78.54.
struct DielectricOptions {
  /// Relative permittivity inside the surface, 1e-9 to 1e9.
  double solute = DielectricMaps{}.solute;
  /// Relative permittivity outside the surface, 1e-9 to 1e9.
  double solvent = DielectricMaps{}.solvent;
};

/// Computes the values of DielectricMaps: the dielectric at the middles of the grid's edges along
/// x, y and z. Each of the three lists has a value for each point of the region, for the edge that
/// starts there, in the order of Result::inside; the middle of the edge is half a spacing from the
/// point, along the axis of the list. The values take 24 bytes for each point.
///
/// Throws std::invalid_argument also if a permittivity is out of its range.
std::array<std::vector<double>, 3> compute_dielectric(const Surface& surface, const Grid& grid,
                                                      const DielectricOptions& dielectric = {},
                                                      const RunOptions& options = {});

/// Computes the values of IonAccessMap: 1 for each point that is outside all spheres of the atoms'
/// radius plus `ion_radius` (angstrom, 0 to 1000; the radius of IonAccessMap is 2), and 0 for the
/// others, in the order of Result::inside.
///
/// Throws std::invalid_argument also if the radius is out of its range.
std::vector<std::uint8_t> compute_ion_access(const Surface& surface, const Grid& grid,
                                             double ion_radius = IonAccessMap{}.ion_radius,
                                             const RunOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
