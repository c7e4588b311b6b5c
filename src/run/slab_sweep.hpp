#pragma once
/// Step 2 of a run: the sweep over the planes of this process, range by range. The rows, crossings
/// and triangles of a range are written to the output files directly, or to a chunk.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "output/output_files.hpp"
#include "run/checkpoint.hpp"
#include "run/progress_report.hpp"
#include "run/run_mesh.hpp"
#include "run/run_plan.hpp"
#include "run/sink.hpp"
#include "run/verifier.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Returns the ranges of planes that this process sweeps, ascending. A run that can be resumed has
/// several ranges, as an interruption loses the current range.
std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan);

/// Returns the number of blocks in these ranges.
std::int64_t count_blocks(const RunPlan& plan, std::span<const PlaneRange> ranges);

/// The result of a sweep that writes to the output files. Other sweeps leave chunks in the
/// checkpoint.
struct SweepResult {
  std::optional<PlaneChunk> chunk;  ///< the texts that are not in their files yet, and the totals
  std::vector<AreaShare> atom_shares;  ///< area share of each atom of the slab
};

/// Sweeps the planes of this process's slab.
class SlabSweep {
 public:
  /// `files` are the output files, and null in processes that write chunks. `mesh` is null without
  /// a mesh. `maps` are the chosen maps if their rows are not written to chunks. Keeps references
  /// to all arguments.
  SlabSweep(const RunTask& task, const RunPlan& plan, std::span<const PlaneRange> ranges,
            OutputFiles* files, RunMesh* mesh, std::deque<GridMap>& maps,
            const Callbacks& callbacks, ProgressReport& report);

  /// Sweeps all ranges. Adds their times and the results of the verification to the summary. A
  /// chunk with faults is not completed.
  SweepResult run(Summary& summary);

 private:
  Plan plan_of(const PlaneRange& planes, std::int64_t checks) const;
  SurfaceModel make_surface() const;
  WriteAt open_text(ChunkText text, PlaneChunk& chunk);
  void add_map_sinks(PlaneChunk& chunk, const GridRegion& region, Sinks& sinks);
  SweepContents contents() const;
  void sweep(PatchSchedule& patches, const Plan& plan, SweepResult& result, Summary& summary);
  bool verify(Verifier& verifier, ChunkInfo& info, Summary& summary);
  void save_chunk(PlaneChunk& chunk, std::span<const AreaShare> shares) const;

  const RunTask& task_;
  const RunPlan& plan_;
  std::span<const PlaneRange> ranges_;
  OutputFiles* files_;
  RunMesh* mesh_;
  std::deque<GridMap>& maps_;
  const Callbacks& callbacks_;
  ProgressReport& report_;
  double check_count_;  // number of points, and of edges, that this process verifies
  // Checksums of the texts of the current chunk; empty without a checkpoint.
  std::optional<std::array<TextChecksum, chunk_text_count>> checksums_;
};

}  // namespace eses::detail
