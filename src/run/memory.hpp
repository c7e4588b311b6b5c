#pragma once
/// Estimates of the memory of a run.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "run/input_atoms.hpp"
#include "run/request.hpp"
#include "surface/survey.hpp"

namespace eses::detail {

struct Schedule;

/// The memory of a process for its part of a run.
struct MemoryBudget {
  /// Returns the free memory in bytes. It is called if the run may need more than
  /// `small_memory_bytes`, or cannot be planned.
  std::function<std::uint64_t()> available;
  /// Bytes that the process holds during the whole run, besides the atoms: labels, and memory of
  /// MPI.
  std::uint64_t held = 0;
  LabelTotals labels = {};  ///< totals of the labels that the process has read
  bool has_groups = false;  ///< whether chains and residues of atoms are numbered
  bool makes_maps = true;   ///< whether this process makes the files of maps
};

/// Returns what the outputs need of each block besides points and crossings.
BlockExtras extras_of(const Outputs& outputs);

/// Returns the expected number of crossings of a surface with a grid. A surface of area A with the
/// normal n crosses A |n_q| / spacing^2 grid lines along the axis q. The mean of
/// |n_x| + |n_y| + |n_z| over all directions is 1.5.
constexpr double expected_crossings(double area, double spacing) {
  return 1.5 * area / (spacing * spacing);
}

/// Returns the ratio of the numbers of crossings with and without the halo. See
/// BlockTiling::region_with_halo.
double halo_growth(const BlockTiling& tiling);

/// Returns a lower bound of expected_memory for this number of atoms, in bytes.
double min_expected_memory(std::size_t atoms);

/// Returns an estimate of the peak memory of the process in bytes, intended as an upper bound, for
/// a grid and the blocks and threads of a schedule. It excludes `budget.held` and the memory of the
/// caller.
double expected_memory(const SurfaceSurvey& survey, const MemoryBudget& budget, const Grid& grid,
                       const Schedule& schedule, const Outputs& outputs);

}  // namespace eses::detail
