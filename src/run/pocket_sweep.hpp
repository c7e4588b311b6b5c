#pragma once
/// The search for pockets: sweeps over the surfaces of two probes on the same grid, layer by layer.

#include "eses/grid.hpp"
#include "eses/place.hpp"
#include "eses/pockets.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Throws std::invalid_argument if an option is out of its range. `probe_radius` is that of the
/// small probe.
void require_valid(const PocketOptions& options, double probe_radius);

/// Returns the grid of a search for pockets.
GridOptions pocket_grid(double spacing);

/// Finds the pockets of a molecule for valid options.
Pockets sweep_pockets(const Molecule& molecule, double probe_radius, const PocketOptions& options);

/// Finds the pockets at a place for valid options.
PlacedPockets sweep_pockets_at(const Molecule& molecule, double probe_radius, const Place& place,
                               const PocketOptions& options);

}  // namespace eses::detail
