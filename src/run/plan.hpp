#pragma once
/// Planning of a run: the grid (plan_grid), the schedule of each process (plan_schedule), and the
/// sizes of the files (plan_files). These functions use neither files nor MPI.

#include <algorithm>
#include <array>
#include <cstdint>

#include "eses/grid.hpp"
#include "geometry/box.hpp"
#include "geometry/plane_range.hpp"
#include "geometry/tiling.hpp"
#include "output/output_files.hpp"
#include "run/memory.hpp"
#include "run/request.hpp"

namespace eses::detail {

/// How a process computes planes of the grid.
struct Schedule {
  BlockTiling tiling;             ///< the blocks of the planes
  int threads = 1;                ///< number of threads
  std::int64_t blocks_ahead = 0;  ///< see WorkList
  double crossings = 0;           ///< expected number of crossings
  /// Estimate of the peak memory of the process, intended as an upper bound, if the process holds
  /// only the atoms before the run.
  std::uint64_t memory_bytes = 0;
};

/// The grid of a run and the part of it to compute, the same in all processes.
struct Plan {
  Grid grid;
  GridRegion region;                   ///< the points to compute
  std::array<double, 6> cut_depths{};  ///< see depths_inside

  /// The planes of the region.
  PlaneRange planes() const { return {region.begin[2], region.end[2]}; }
  /// The corners of all cells that belong to the region: those whose lowest corner is in it.
  GridRegion region_with_halo() const { return with_halo(region, grid.size); }
  /// Whether the region contains the whole surface.
  bool is_whole_surface() const { return cut_depth() <= 0 && region == grid.whole(); }

  /// The distance by which the bounding box of the van der Waals spheres extends beyond the grid
  /// (angstrom). It is positive if the grid cuts the box, 0 if the box reaches a face of the grid
  /// up to rounding errors, and negative if the grid encloses it.
  double cut_depth() const { return std::ranges::max(cut_depths); }
};

/// Takes the grid of the parameters or, if they have none, makes the grid around atoms with these
/// bounds, and determines the region to compute. Throws std::invalid_argument if a parameter is out
/// of its range, if the part of the grid is empty or not within the grid, or if the margin is so
/// small that the grid would cut the surface (see doc/grid.md).
Plan plan_grid(const Box& bounds, const Parameters& parameters);

/// Throws std::invalid_argument if the probe radius, the number of threads or the number of points
/// to verify is out of its range.
void require_valid(const Parameters& parameters);

/// Throws std::invalid_argument if the mesh or a map has an unknown suffix, if two maps have the
/// same name, if a number of a map is out of its range, or if the molecule lacks labels that the
/// outputs need.
void require_valid(const Outputs& outputs, const Molecule& molecule);

/// Chooses block size, threads and number of blocks ahead for planes of the region, as far as the
/// request does not give them, so that neither `max_memory` nor the available memory is exceeded.
/// `molecule` must have the atoms that influence these planes. Throws LimitExceeded or GridTooLarge
/// if the run needs more memory.
Schedule plan_schedule(const MemoryBudget& budget, const Molecule& molecule, const Request& request,
                       const Plan& plan, const PlaneRange& planes);

/// Estimates the sizes of the files and of the scratch files for this number of atoms. `labels` are
/// the totals of all atoms. `has_chunks` tells whether texts are in the checkpoint until they are
/// merged. `schedule` has the crossings of the whole region.
FileSizes plan_files(std::uint64_t atoms, const LabelTotals& labels, const Request& request,
                     bool has_chunks, const Plan& plan, const Schedule& schedule);

}  // namespace eses::detail
