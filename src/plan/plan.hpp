#pragma once
/// Plans of runs. A plan is made in three steps: the grid (plan_grid), the schedule of a process
/// (plan_schedule), and the sizes of the files (plan_files). This folder uses neither files nor
/// MPI.

#include <cstdint>
#include <span>
#include <string>

#include "grid/make_grid.hpp"
#include "plan/memory.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Makes a plan. Chooses block size, threads and number of blocks in flight as far as they are not
/// given, so that neither `max_memory` nor the available memory is exceeded. Throws Error if a
/// parameter is out of its range, if the margin is so small that the grid would cut the surface
/// (see doc/grid.md), if a bound of the region is not finite, or if the run needs more memory than
/// is available or allowed.
Plan make_plan(const Molecule& molecule, const Parameters& parameters, const Outputs& outputs);

/// Makes a plan for a machine on which `available` bytes of memory are free.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const Outputs& outputs);

/// Returns Plan::atoms_checksum for these atoms.
std::uint64_t checksum_of(std::span<const Atom> atoms);

/// Performs step 1 of a plan: takes the grid of the parameters or, if they have none, makes the
/// grid around atoms with these bounds, and determines the region.
Plan plan_grid(const Box& bounds, const Parameters& parameters);

/// Performs step 1 of a plan for a given grid. `parameters.margin` is ignored, and
/// `parameters.spacing` must be that of the grid.
Plan plan_on_grid(const Grid& grid, const Box& bounds, const Parameters& parameters);

/// Throws Error if the probe radius, the number of threads or the number of points to verify is out
/// of its range.
void require_valid(const Parameters& parameters);

/// Throws Error if the mesh or a map has an unknown suffix, if two maps have the same name, if a
/// number of a map is out of its range, or if the molecule lacks labels that the outputs need.
void require_valid(const Outputs& outputs, const Molecule& molecule);

/// The memory of a process for its part of a run.
struct MemoryBudget {
  std::uint64_t available = 0;  ///< free memory in bytes
  /// Memory for communication with other MPI ranks and for names of atoms, in bytes.
  std::uint64_t held = 0;
  LabelTotals labels;            ///< labels in the memory of the process
  double held_per_crossing = 0;  ///< memory that the caller needs for each crossing, in bytes
};

/// Performs step 2 of a plan: chooses the schedule for the region of `plan.tiling`. `molecule` must
/// have the atoms that influence the region. Returns the expected number of crossings in the
/// region.
double plan_schedule(const MemoryBudget& budget, const Molecule& molecule, const Outputs& outputs,
                     Plan& plan);

/// Performs steps 2 and 3 of a plan for a single process with the whole molecule, whose labels are
/// added to the budget. Returns the expected number of crossings.
double plan_alone(MemoryBudget budget, const Molecule& molecule, const Outputs& outputs,
                  Plan& plan);

/// The contents of a run's files, as far as their sizes depend on them.
struct FileContents {
  std::uint64_t atoms = 0;
  double crossings = 0;  ///< expected number
  /// Labels of all atoms. Only the numbers of runs and the lengths of names are used.
  LabelTotals labels;
};

/// Performs step 3 of a plan: estimates the sizes of the files and of the scratch files.
void plan_files(const FileContents& contents, const Outputs& outputs, Plan& plan);

}  // namespace eses::detail
