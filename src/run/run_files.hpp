#pragma once
/// The output files of a run, from their sinks to their final names.

#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "eses/summary.hpp"
#include "output/grid_map.hpp"
#include "output/output_files.hpp"
#include "run/mesh_sink.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// The output files of a run. Only the first process has them. A part of a run has none.
class RunFiles {
 public:
  /// Opens the files. Keeps a reference to `run`.
  explicit RunFiles(PlannedRun& run);

  /// Returns the sink of all pieces. The first call makes the maps.
  Sink& sink();

  // `check` is called repeatedly, also from several threads at the same time, and may end the run
  // by an exception.

  /// Finishes the mesh, completes all files, and gives them their final names. Sets the number of
  /// written bytes and the counts of the mesh in the summary, whose areas are written.
  void finish(const std::function<void()>& check, Summary& summary);

 private:
  OutputFile& file(RunFile which) { return *files_->find(which); }
  void write_areas_of(std::span<const double> areas, const std::function<void()>& check);
  void write_box();
  // A valid gzip file has at least one member, also without text.
  void complete_gzip(RunFile which);

  PlannedRun& run_;
  std::optional<OutputFiles> files_;  // without a value if the run writes nothing
  std::optional<MeshSink> mesh_;
  std::optional<Sinks> sinks_;
  std::deque<GridMap> maps_;
};

}  // namespace eses::detail
