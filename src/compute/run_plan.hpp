#pragma once
/// Step 1 of a run: from the input file to the plan, and to the atoms of each process.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "distributed/atom_share.hpp"
#include "distributed/group_numbers.hpp"
#include "distributed/processes.hpp"
#include "distributed/slabs.hpp"
#include "eses/read_atoms.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// What the user has chosen.
struct RunTask {
  std::filesystem::path input = {};
  AtomFormat format = AtomFormat::automatic;
  Parameters parameters;
  Outputs outputs;
  std::filesystem::path output_directory;
  /// Keep finished chunks on disk, and go on from those that an earlier run has left.
  bool resume = false;
  bool dry_run = false;  ///< create nothing
};

/// What the processes have agreed upon, and what this one has of the molecule.
struct RunPlan {
  Plan whole;  ///< of the whole run; memory and threads are the maxima over the processes
  Plan own;    ///< of this process's slab
  Slab slab;
  FileDiagnostics diagnostics;
  std::uint64_t atoms = 0;  ///< number of atoms in the molecule
  AtomRange read;           ///< the atoms that this process has read
  ResidueRuns residues;     ///< of the atoms in `read`, if tables of residues are written
  GroupNames groups;        ///< first seen in `read`, if the mesh names them
  std::unique_ptr<Checkpoint>
      checkpoint;                ///< of a run that can be resumed; the first process locks it
  std::vector<PlaneRange> done;  ///< planes whose chunks an earlier run has left
};

/// Reads the input and makes the plan; to be called by all processes. Throws SharedError where
/// reading the atoms or make_plan would throw Error, and if the memory limit cannot be kept.
RunPlan plan_run(const RunTask& task, const Processes& processes);

/// The plan of a process that is alone for a molecule in memory, with what make_plan has chosen.
RunPlan plan_of_molecule(const Molecule& molecule, const Plan& plan, const Outputs& outputs);

}  // namespace eses::detail
