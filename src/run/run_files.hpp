#pragma once
/// The output files of a run, from their sinks to their final names.

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "eses/summary.hpp"
#include "mesh/quality_filter.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_file.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_files.hpp"
#include "run/layer_mesh.hpp"
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
  VertexMaker vertex_maker() const;
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

/// The output files of a run. The first process opens them. The others have only what they need to
/// make pieces of the mesh.
class RunFiles {
 public:
  /// Opens the files if `is_first`, and nothing for a part of a run. Keeps a reference to `run`.
  RunFiles(PlannedRun& run, bool is_first);

  /// The mesh, or null if there is none.
  RunMesh* mesh() { return mesh_ ? &*mesh_ : nullptr; }
  /// Returns the sink of all pieces in the first process. The first call makes the maps.
  Sink& sink();

  // `check` is called repeatedly, also from several threads at the same time, and may end the run
  // by an exception.

  /// Finishes the mesh, completes all files, and gives them their final names. Sets the number of
  /// written bytes and the counts of the mesh in the summary, whose areas are written.
  void finish(const std::function<void()>& check, Summary& summary);

 private:
  OutputFile& file(RunFile which) { return *files_->find(which); }
  void write(GridMap& map, const std::function<void()>& check);
  void write_areas_of(std::span<const double> areas, const std::function<void()>& check);
  void write_box();
  // A valid gzip file has at least one member, also without text.
  void complete_gzip(RunFile which);

  PlannedRun& run_;
  std::unique_ptr<OutputFiles> files_;
  std::optional<RunMesh> mesh_;
  std::optional<Sinks> sinks_;
  std::deque<GridMap> maps_;
};

}  // namespace eses::detail
