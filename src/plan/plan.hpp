#pragma once
/// Plans: the grid, the schedule of a process, and the sizes of the files. May use everything below
/// the sweep, but neither other processes nor files.

#include <cstdint>
#include <span>
#include <string>

#include "grid/make_grid.hpp"
#include "plan/memory.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Grid, tiling, memory and bytes of output; what is left to it, block size, threads and blocks in
/// flight, it chooses so that `max_memory` and what memory is available are kept. Throws Error if a
/// parameter is out of its range, if the margin is so small that the grid would cut the surface
/// (see README), if a bound of the region is not finite, or if memory cannot hold what the run
/// needs, or may not.
Plan make_plan(const Molecule& molecule, const Parameters& parameters, const Outputs& outputs);

/// make_plan where `available` bytes of memory are free: the plan keeps them as it keeps
/// `max_memory`.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const Outputs& outputs);

/// What `Plan::atoms_checksum` is for these atoms.
std::uint64_t checksum_of(std::span<const Atom> atoms);

/// Step 1 of a plan: the grid around atoms with these bounds or, if there is one, the grid of the
/// parameters, and the region to compute.
Plan plan_grid(const Box& bounds, const Parameters& parameters);

/// The same for a grid that is there already. `parameters.margin` has no meaning, and
/// `parameters.spacing` must be that of the grid.
Plan plan_on_grid(const Grid& grid, const Box& bounds, const Parameters& parameters);

/// Throws Error if the probe radius, the number of threads or that of points to verify is out of
/// its range.
void require_valid(const Parameters& parameters);

/// Throws Error if the files cannot be of this molecule: if the mesh or the map has an unknown
/// suffix, or if labels are missing.
void require_valid(const Outputs& outputs, const Molecule& molecule);

/// The memory that a process has for its part of a run.
struct MemoryBudget {
  std::uint64_t available = 0;   ///< bytes of memory that are free
  std::uint64_t held = 0;        ///< bytes that the process holds for exchange with other processes
  LabelTotals labels;            ///< the labels that the process holds
  double held_per_crossing = 0;  ///< bytes that the process will hold for each crossing
};

/// Step 2: chooses the schedule for the region of `plan.tiling`. `molecule` must hold the atoms
/// that influence the region. Returns the expected number of crossings in the region.
double plan_schedule(const MemoryBudget& budget, const Molecule& molecule, const Outputs& outputs,
                     Plan& plan);

/// Steps 2 and 3 for a process that is alone and has the whole molecule, whose labels it adds to
/// the budget. Returns the expected number of crossings.
double plan_alone(MemoryBudget budget, const Molecule& molecule, const Outputs& outputs,
                  Plan& plan);

/// What the sizes of the files of a whole run depend on, beside its plan.
struct FileContents {
  std::uint64_t atoms = 0;
  double crossings = 0;  ///< expected
  /// Residues and chains of all atoms. Only their numbers and the bytes of their names matter.
  LabelTotals labels;
};

/// Step 3: the sizes of the files, and of what the disk holds beside them during the run.
void plan_files(const FileContents& contents, const Outputs& outputs, Plan& plan);

}  // namespace eses::detail
