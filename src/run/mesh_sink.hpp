#pragma once
/// The mesh of a run on its way to the file.

#include <functional>
#include <optional>

#include "eses/summary.hpp"
#include "mesh/quality_filter.hpp"
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

}  // namespace eses::detail
