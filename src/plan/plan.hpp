#pragma once
/// Plans: the grid, the schedule of a process, and the sizes of the files. May use everything below
/// the sweep, but neither other processes nor files.

#include <cstdint>
#include <span>
#include <string>

#include "eses/run.hpp"
#include "plan/memory.hpp"

namespace eses {

/// make_plan where `available` bytes of memory are free: the plan keeps them as it keeps
/// `max_memory`.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const OutputChoice& outputs);

/// What `Plan::atoms_checksum` is for these atoms.
std::uint64_t checksum_of(std::span<const Atom> atoms);

/// Step 1 of a plan: the grid around atoms with these bounds, and the region to compute.
Plan plan_grid(const SphereBounds& bounds, const Parameters& parameters);

/// The memory that a process has for its part of a run.
struct MemoryBudget {
  std::uint64_t available = 0;  ///< bytes of memory that are free
  std::uint64_t held = 0;       ///< bytes that the process holds for exchange with other processes
  LabelTotals labels;           ///< the labels that the process holds
};

/// Step 2: chooses the schedule for the region of `plan.tiling`. `molecule` must hold the atoms
/// that influence the region. Returns the expected number of crossings in the region.
double plan_schedule(const MemoryBudget& budget, const Molecule& molecule,
                     const OutputChoice& outputs, Plan& plan);

/// What the sizes of the files of a whole run depend on, beside its plan.
struct FileContents {
  std::uint64_t atoms = 0;
  double crossings = 0;  ///< expected
  /// Residues and chains of all atoms. Only their numbers and the bytes of their names matter.
  LabelTotals labels;
};

/// Step 3: the sizes of the files, and of what the disk holds beside them during the run.
void plan_files(const FileContents& contents, const OutputChoice& outputs, Plan& plan);

}  // namespace eses
