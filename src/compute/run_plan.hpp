#pragma once
/// Step 1 of a run: reading the input (distributed/atom_share.hpp), planning (plan/plan.hpp), and
/// sending the atoms to the processes (distributed/slabs.hpp). Step 2 is in slab_sweep.hpp.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "distributed/atom_share.hpp"
#include "distributed/group_numbers.hpp"
#include "distributed/processes.hpp"
#include "distributed/slabs.hpp"
#include "eses/read_atoms.hpp"
#include "io/atom_names.hpp"
#include "solve/block_solver.hpp"
#include "sweep/pipeline.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Maps that the caller of a run in a single process receives.
struct MapsInMemory {
  std::vector<MapSink> sinks;
  BlockExtras extras;  ///< what the maps need besides points
};

/// The choices of the user for a run.
struct RunTask {
  std::filesystem::path input = {};
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure = {};  ///< options for PDB and mmCIF files
  Parameters parameters;
  Outputs outputs;
  std::filesystem::path output_directory;
  /// Whether to keep finished chunks on disk, and to continue from those of an earlier run.
  bool resume = false;
  bool dry_run = false;  ///< whether to create no files
  MapsInMemory maps_in_memory = {};
};

/// The plan of a run, and the part of the molecule that this process has.
struct RunPlan {
  Plan whole;  ///< plan of the whole run; memory and threads are maxima over the processes
  Plan own;    ///< plan of this process's slab
  Slab slab;
  FileDiagnostics diagnostics;
  std::uint64_t atoms = 0;  ///< number of atoms in the molecule
  AtomRange read;           ///< atoms that this process has read
  ResidueRuns residues;     ///< residues of the atoms in `read`, if tables of residues are written
  GroupNames groups;        ///< groups whose first atom is in `read`, if the mesh names them
  /// Names of the atoms in `read`, if atoms.csv is written and the file has names. A molecule in
  /// memory has labels instead.
  AtomNames names;
  /// Radii of the atoms in `read` (angstrom), if several processes write atoms.csv.
  std::vector<double> radii;
  /// The report of reading a PDB or mmCIF file; only in the first process.
  std::optional<StructureReport> structure;
  /// Checkpoint of a run that can be resumed, else null. The first process locks it.
  std::unique_ptr<Checkpoint> checkpoint;
  std::vector<PlaneRange> done;  ///< planes of the chunks of an earlier run
};

/// Reads the input and makes the plan. All processes must call it. Throws SharedError if reading
/// the atoms or make_plan would throw Error, and if the memory limit is exceeded.
RunPlan plan_run(const RunTask& task, const Processes& processes);

/// Returns the plan of a single process for a molecule in memory. `plan` is the result of
/// make_plan.
RunPlan plan_of_molecule(const Molecule& molecule, const Plan& plan, const Outputs& outputs);

/// Returns whether texts are written directly to the output files: a single process sweeps the
/// whole region as one range.
bool writes_in_place(const RunTask& task, const Processes& processes);

}  // namespace eses::detail
