#pragma once
/// A run that several processes share, or that can be resumed: the same files as `run` writes.
///
/// Each process reads a part of the atoms, gets those that matter to its slab of the grid, builds
/// their patches, and solves the blocks of its slab into pieces of text, which are joined in the
/// files when all are there. Nothing that is written depends on who did what.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "checkpoint/pieces.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_groups.hpp"
#include "distributed/slabs.hpp"
#include "eses/read_atoms.hpp"
#include "eses/run.hpp"

namespace eses {

/// What a joint run is asked for.
struct JointTask {
  std::filesystem::path input;
  AtomFormat format = AtomFormat::automatic;
  Parameters parameters;
  OutputChoice outputs;
  std::filesystem::path output_directory;
  /// Pieces outlive a run that is cut off, and are not done again.
  bool resume = false;
  bool dry_run = false;  ///< nothing may be created
};

/// What the processes have agreed upon.
struct JointPlan {
  Plan whole;  ///< of all processes together, but memory and threads, which are those of one
  Plan own;    ///< of this one's slab
  SlabShare slab;
  SharedOddities odd;
  std::uint64_t atoms = 0;            ///< of the molecule
  AtomRange read;                     ///< of the atoms, those that this process has read
  ResidueRuns residues;               ///< of these, if tables of them are asked for
  OwnGroups groups;                   ///< of these, if the mesh has chains and residues
  std::unique_ptr<PieceStore> store;  ///< if the run may be resumed; locked by the first process
  std::vector<PlaneRange> done;       ///< planes that need not be done again
};

/// What each process had to do.
struct ProcessFigures {
  PlaneRange planes;
  std::uint64_t atoms = 0;  ///< that matter there
  double cpu_seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
};

/// Makes the plan. To be called by all processes, as `run_jointly`. Throws SharedError where
/// reading the atoms or make_plan would throw Error.
JointPlan plan_jointly(const JointTask& task, const Processes& processes);

struct JointSummary {
  Summary summary;  ///< without atom_areas; the same in all processes but for the seconds
  std::vector<ProcessFigures> processes;  ///< by rank
};

/// What the processes together make, and must not leave behind.
struct JointPaths {
  std::vector<std::string> temporaries, locks;
};

/// Those of the first process, known to all.
JointPaths joint_paths(const JointTask& task, const Processes& processes);

/// As `run` does. If it throws anything but SharedError, the other processes do not know, and have
/// to be aborted.
JointSummary run_jointly(const JointTask& task, const JointPlan& plan, const JointPaths& paths,
                         const Callbacks& callbacks, const Processes& processes);

}  // namespace eses
