#pragma once
/// Step 2 of a run: the sweep over the planes of this process, range by range.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "run/planned_run.hpp"
#include "run/progress_report.hpp"
#include "run/run_mesh.hpp"
#include "run/sink.hpp"
#include "run/sweep.hpp"
#include "run/verifier.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Returns the ranges of planes that this process sweeps, ascending. A run that can be resumed has
/// several ranges, as an interruption loses the current range.
std::vector<PlaneRange> ranges_to_sweep(const PlannedRun& run);

/// Returns the number of blocks in these ranges.
std::int64_t count_blocks(const PlannedRun& run, std::span<const PlaneRange> ranges);

/// Sweeps the planes of this process's slab.
class SlabSweep {
 public:
  /// `mesh` is null without a mesh. Keeps references to all arguments.
  SlabSweep(const PlannedRun& run, std::span<const PlaneRange> ranges, const RunMesh* mesh,
            const Callbacks& callbacks, ProgressReport& report);

  /// Sweeps the next range into a sink, and then verifies its share of the points and edges. Adds
  /// times and the results of the verification to the summary.
  SweepSums sweep(const PlaneRange& planes, Sink& sink, Summary& summary);

 private:
  Plan plan_of(const PlaneRange& planes);
  SurfaceModel make_surface() const;
  SweepContents contents() const;
  void verify(Verifier& verifier, SweepSums& sums, Summary& summary);

  const PlannedRun& run_;
  const RunMesh* mesh_;
  const Callbacks& callbacks_;
  ProgressReport& report_;
  std::shared_ptr<ScheduledSurface> surface_;  // null before the first range
  double check_count_;  // number of points, and of edges, that this process verifies
  std::int64_t all_planes_, swept_planes_ = 0;
};

}  // namespace eses::detail
