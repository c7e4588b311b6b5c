#pragma once
/// Step 1 of a run: reading the input (distributed/atom_part.hpp), planning (run/plan.hpp), and
/// sending the atoms to the processes (run/slabs.hpp). Step 2 is in slab_sweep.hpp.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "distributed/atom_part.hpp"
#include "distributed/checkpoint.hpp"
#include "distributed/group_numbers.hpp"
#include "distributed/processes.hpp"
#include "input/atom_names.hpp"
#include "input/potential_map.hpp"
#include "run/plan.hpp"
#include "run/slabs.hpp"
#include "run/task.hpp"
#include "surface/cavity_map.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// The plan of a whole run, and the part of the run that belongs to this process. In the plan of
/// the whole run, `threads`, `blocks_ahead`, `memory_bytes` and the block size are maxima over the
/// processes. A process uses `process_schedule`.
struct RunPlan : Plan {
  Schedule process_schedule;  ///< for the slab
  Slab slab;
  /// Whether texts are written directly to the output files: a single process sweeps the whole
  /// region as one range.
  bool is_in_place = true;
  FileDiagnostics diagnostics;
  std::uint64_t atoms = 0;  ///< number of atoms in the molecule
  IndexRange read_atoms;    ///< indices of the atoms that this process has read
  GroupNames groups;        ///< groups whose first atom is in `read_atoms`, if the mesh names them
  /// Residues of the atoms in `read_atoms`, if tables of residues are written. Also names of the
  /// atoms, if atoms.csv is written and the file has names; a molecule in memory has labels
  /// instead.
  AtomNames names;
  /// Radii of the atoms in `read_atoms` (angstrom), if several processes write atoms.csv.
  std::vector<double> radii;
  std::optional<PotentialMap> potential;  ///< of the vertices of the mesh, if it has one
  /// The report of reading a PDB or mmCIF file; only in the first process.
  std::optional<StructureReport> structure;
  /// Checkpoint of a run that can be resumed, else null. The first process locks it.
  std::unique_ptr<Checkpoint> checkpoint;
  /// The cavities, with the atoms of the slab; null if the run does not need them.
  std::shared_ptr<const CavityMap> cavities;
  /// The surface, if its patches are kept: those of the search for cavities, or of exact measures.
  /// Else null.
  std::shared_ptr<ScheduledSurface> patches;
  std::vector<PlaneRange> finished_planes;  ///< planes of the chunks of an earlier run

  /// Returns the cavities if some component is filled, else null.
  std::shared_ptr<const CavityMap> filled() const {
    return cavities && cavities->has_filled() ? cavities : nullptr;
  }
};

/// Makes the plan of a run: reads the file of the task, or takes its molecule. All processes must
/// call it. Throws SharedError if the atoms cannot be read, if a parameter or an output is not
/// possible for them, and if the run would exceed the memory.
RunPlan plan_run(const RunTask& task, const Processes& processes);

}  // namespace eses::detail
