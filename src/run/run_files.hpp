#pragma once
/// The output files of a run, from their sinks to their final names.

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "output/grid_map.hpp"
#include "output/output_files.hpp"
#include "run/merge.hpp"
#include "run/planned_run.hpp"
#include "run/request.hpp"
#include "run/run_mesh.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// The output files of a run. The first process opens them. The others have only what they need to
/// make pieces of the mesh.
class RunFiles {
 public:
  /// Opens the files if `is_first`, and nothing for a part of a run. Keeps references to `request`
  /// and `run`.
  RunFiles(const Request& request, PlannedRun& run, bool is_first);

  /// The mesh, or null if there is none.
  RunMesh* mesh() { return mesh_ ? &*mesh_ : nullptr; }
  /// The sink of a sweep in place.
  Sink& sink() { return sinks_; }
  /// Finishes the mesh, completes all files, and gives them their final names. `merge` has the
  /// chunks of the run; it is null after a sweep in place. Sets the number of written bytes and the
  /// counts of the mesh in the summary, whose areas are written. `check` is called repeatedly, and
  /// may end the run by an exception.
  void finish(Merge* merge, const std::function<void()>& check, Summary& summary);

 private:
  OutputFile& file(RunFile which) { return *files_->find(which); }
  void add_sinks();
  std::uint64_t write_text(Merge* merge, RunFile which, ChunkText text, const PieceTextSink* sink);
  std::uint64_t write_maps(Merge* merge, const std::function<void()>& check);
  std::uint64_t write_areas_of(std::span<const double> areas, const std::function<void()>& check);
  std::uint64_t write_box();

  const Request& request_;
  PlannedRun& run_;
  std::unique_ptr<OutputFiles> files_;
  std::optional<RunMesh> mesh_;
  Sinks sinks_;
  PieceTextSink *grid_ = nullptr, *edges_ = nullptr;
  std::deque<GridMap> maps_;  // of a sweep in place; with chunks, one after the other is made
};

}  // namespace eses::detail
