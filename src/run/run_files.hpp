#pragma once
/// The output files of a run, from their sinks to their final names.

#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "eses/summary.hpp"
#include "mesh/quality_filter.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_file.hpp"
#include "output/output_files.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// Writes the meshes of pieces, after their improvement if it is chosen.
class MeshSink final : public Sink {
 public:
  /// Keeps references to both. Writes the header of the file.
  MeshSink(const PlannedRun& run, OutputFiles& files);

  void prepare(RowPiece& piece) override;
  void place(RowPiece& piece) override;
  void store(const RowPiece& piece) override;
  /// Finishes the mesh after all pieces were added. Sets its counts and angles in the summary.
  void finish(Summary& summary);
  /// Completes the file after `finish`.
  void write(const std::function<void()>& check) { file_.finish(check); }

 private:
  mesh::MeshFile file_;
  std::optional<mesh::QualityFilter> filter_;
};

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
