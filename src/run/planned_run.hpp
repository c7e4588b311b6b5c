#pragma once
/// Step 1 of a run: reading the input, planning (run/plan.hpp), and choosing the planes and atoms
/// of this process (run/slabs.hpp). Step 2 is in engine.hpp.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "distributed/processes.hpp"
#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"
#include "input/potential_map.hpp"
#include "output/mesh_groups.hpp"
#include "run/checkpoint.hpp"
#include "run/far_atoms.hpp"
#include "run/file_diagnostics.hpp"
#include "run/plan.hpp"
#include "run/request.hpp"
#include "run/slabs.hpp"
#include "surface/cavity_map.hpp"
#include "surface/find_cavities.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// A run that is ready: its plan, its input, and the part of it that belongs to this process.
struct PlannedRun {
  /// The number of threads is that of this process, if it shares a machine with others.
  Request request;
  Plan plan;
  Share share;  ///< of the parts of a run, or of its MPI ranks
  Slab slab;
  std::uint64_t atoms = 0;  ///< number of atoms of the file or molecule
  std::optional<FarAtomsWarning> far_atoms;
  FileDiagnostics diagnostics;  ///< of all atoms; only in the first process
  mesh::GroupNames groups;      ///< if the mesh names or colours them
  LabelTotals labels;           ///< totals of the labels that were read
  /// Residues of the atoms, if tables of residues are written. Also names of the atoms, if
  /// atoms.csv is written and the file has names; a molecule in memory has labels instead. Only in
  /// the first process.
  AtomNames names;
  /// Radii of all atoms (angstrom), if atoms.csv is written and the slab does not have all atoms.
  /// Only in the first process.
  std::vector<double> radii;
  std::optional<PotentialMap> potential;  ///< of the vertices of the mesh, if it has one
  /// The report of reading a PDB or mmCIF file; only in the first process.
  std::optional<StructureReport> structure;
  /// The checkpoint, in which each range of planes becomes a chunk. The first process locks it. It
  /// is null if a single process writes its pieces straight into the output files.
  std::unique_ptr<Checkpoint> checkpoint;
  /// The cavities, with the atoms of the slab, if the run needs them; and the surface, if its
  /// patches are kept: those of the search for cavities, or of exact measures.
  FoundCavities cavities;
  /// Planes of the chunks of an earlier run, ascending and disjoint.
  std::vector<PlaneRange> finished_planes;

  /// Returns the cavities if some component is filled, else null.
  std::shared_ptr<const CavityMap> filled() const {
    return cavities.map && cavities.map->has_filled() ? cavities.map : nullptr;
  }
};

/// Plans a run: reads the file of the request, or takes its molecule. All processes must
/// call it. Throws SharedError if the atoms cannot be read, if a parameter or an output is not
/// possible for them, and if the run would exceed the memory.
PlannedRun plan_run(Request request, const Processes& processes);

/// Returns the surface near the slab of a process, whose patches a sweep builds or finds built.
std::shared_ptr<ScheduledSurface> surface_of(const PlannedRun& run);

}  // namespace eses::detail
