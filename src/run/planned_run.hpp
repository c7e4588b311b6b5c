#pragma once
/// Step 1 of a run: reading the input (run/input_atoms.hpp), planning (run/plan.hpp), and dividing
/// the planes of the grid among the processes. Each process reads all atoms. It gets a slab of
/// consecutive planes and keeps the atoms that influence it. All slabs take about the same time.
/// Step 2 is in engine.hpp.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/plane_range.hpp"
#include "input/atom_names.hpp"
#include "output/output_files.hpp"
#include "run/checkpoint.hpp"
#include "run/input_atoms.hpp"
#include "run/plan.hpp"
#include "run/request.hpp"
#include "surface/cavity_map.hpp"
#include "surface/find_cavities.hpp"
#include "surface/molecule.hpp"
#include "surface/patch_schedule.hpp"
#include "system/processes.hpp"

namespace eses::detail {

/// The planes of a process, and the atoms that influence them. A single process has all atoms.
struct Slab {
  PlaneRange planes;                       ///< may be empty
  Molecule molecule{std::vector<Atom>()};  ///< without labels
  /// Index in the file of each atom of the molecule, ascending; empty if the molecule has all
  /// atoms.
  std::vector<FileIndex> atoms_in_file;
  std::vector<GroupNumbers> groups;  ///< by atom; empty if groups are not numbered
  /// The cavities, with these atoms, if the run needs them; and the surface, if its patches are
  /// kept: those of the search for cavities, or of exact measures.
  FoundCavities cavities;

  FileIndices file_indices() const { return FileIndices(atoms_in_file); }
  /// Returns the cavities if some component is filled, else null.
  std::shared_ptr<const CavityMap> filled() const {
    return cavities.map && cavities.map->has_filled() ? cavities.map : nullptr;
  }
};

/// A run that is ready: its plan, its input, and the part of it that belongs to this process.
struct PlannedRun {
  /// The number of threads is that of this process, if it shares a machine with others.
  Request request;
  Share share;  ///< of the parts of a run, or of its MPI ranks
  InputInfo input;
  Plan plan;
  /// The checkpoint, in which each range of planes becomes a chunk. The first process locks it. It
  /// is null if a single process writes its pieces straight into the output files.
  std::unique_ptr<Checkpoint> checkpoint;
  /// Planes of the chunks of an earlier run, ascending and disjoint.
  std::vector<PlaneRange> finished_planes;
  Slab slab;
  Schedule schedule;  ///< of the slab
  /// Threads, blocks and memory are maxima over the processes; the crossings are those of the whole
  /// region. For reports and sizes of files: no process sweeps it.
  Schedule largest_schedule;
  FileSizes file_sizes;
};

/// Plans a run: reads the file of the request, or takes its molecule. All processes must
/// call it. Throws SharedError if the atoms cannot be read, if a parameter or an output is not
/// possible for them, and if the run would exceed the memory.
PlannedRun plan_run(Request request, const Processes& processes);

/// Returns the surface near the slab of a process, whose patches a sweep builds or finds built.
std::shared_ptr<ScheduledSurface> surface_of(const PlannedRun& run);

/// Cuts `costs` into `parts` consecutive ranges with nearly equal sums; ranges may be empty.
/// Returns the begin of each range, and the number of costs.
std::vector<std::size_t> cut_evenly(std::span<const double> costs, int parts);

/// Returns the number of planes in ranges that do not overlap.
std::int64_t plane_count(std::span<const PlaneRange> ranges);

}  // namespace eses::detail
