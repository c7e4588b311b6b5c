#pragma once
/// The mesh of a run, from the pieces of the sweep to its file.

#include <functional>
#include <optional>

#include "eses/summary.hpp"
#include "mesh/quality_filter.hpp"
#include "output/mesh_file.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_files.hpp"
#include "output/vertex_maker.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// The mesh of a run. The first process writes its file, and has its `files`; they are null in the
/// others, which only make pieces.
class RunMesh final : public Sink {
 public:
  /// Keeps a reference to `run`. Writes the header of the file.
  RunMesh(const PlannedRun& run, OutputFiles* files);

  /// The lists that the sweep makes of each piece.
  mesh::PieceContents swept_contents() const {
    return choice_.quality ? mesh::PieceContents() : text_.piece_contents();
  }
  /// Makes the vertices of the pieces.
  mesh::VertexMaker vertex_maker() const;
  void prepare(Piece& piece) override;
  void place(Piece& piece) override;
  void store(const Piece& piece) override;
  /// Finishes the mesh after all pieces were added. Sets its counts and angles in the summary.
  void finish(Summary& summary);
  /// Completes the file after `finish`.
  void write(const std::function<void()>& check) { file_->finish(check); }

 private:
  const PlannedRun& run_;
  const MeshOptions& choice_;
  mesh::MeshText text_;
  std::optional<mesh::MeshFile> file_;
  std::optional<mesh::QualityFilter> filter_;
};

}  // namespace eses::detail
