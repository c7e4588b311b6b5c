#pragma once
/// Step 3 of a run: the chunks of all processes become the output files, by one process.

#include <functional>
#include <vector>

#include "run/checkpoint.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// The chunks of a checkpoint, all together.
class Merge {
 public:
  /// Reads the sums of all chunks. `check` is called repeatedly, and may end the run by an
  /// exception. Keeps a reference to `run`. Throws Error if the chunks do not cover the region
  /// exactly, or if the mesh has too many vertices.
  Merge(PlannedRun& run, std::function<void()> check);

  /// The sums of all chunks, with the area share of each atom of the file.
  SweepSums& sums() { return sums_; }
  /// Passes the pieces of all chunks to a sink, as one sweep over the region would. Throws Error if
  /// a chunk is damaged.
  void replay(Sink& sink);

 private:
  PlannedRun& run_;
  std::function<void()> check_;
  std::vector<PlaneChunk> chunks_;  // sorted by planes
  SweepSums sums_;
};

}  // namespace eses::detail
