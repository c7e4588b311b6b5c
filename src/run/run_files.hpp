#pragma once
/// The output files of a run, from their sinks to their final names.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "eses/summary.hpp"
#include "mesh/quality_filter.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_file.hpp"
#include "output/output_files.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// The output files of a run: a sink that writes pieces. Only the first process has them. A part of
/// a run has none.
class RunFiles final : public Sink {
 public:
  /// Opens the files. Keeps a reference to `run`.
  explicit RunFiles(PlannedRun& run);

  /// Returns the sink of all pieces: these files, or the sink of a request without files. The first
  /// call makes the maps.
  Sink& sink();
  void prepare(RowPiece& piece) override;
  void place(RowPiece& piece) override;
  void store(const RowPiece& piece) override;

  /// Finishes the mesh, completes all files, and gives them their final names. Sets the number of
  /// written bytes and the counts of the mesh in the summary, whose areas are written. `check` is
  /// called repeatedly, also from several threads at the same time, and may end the run by an
  /// exception.
  void finish(const std::function<void()>& check, Summary& summary);

 private:
  // A file with a text of the pieces, one after the other.
  struct TextFile {
    PieceText RowPiece::*text;
    OutputFile& file;
    std::uint64_t size = 0;
  };

  OutputFile& file(RunFile which) { return *files_->find(which); }
  void open_mesh(const MeshOptions& mesh);
  void finish_mesh(Summary& summary);
  void write_areas_of(std::span<const double> areas, const std::function<void()>& check);
  void write_box();

  PlannedRun& run_;
  std::optional<OutputFiles> files_;  // without a value if the run writes nothing
  std::vector<TextFile> texts_;
  std::deque<GridMap> maps_;
  std::optional<mesh::MeshFile> mesh_;
  std::optional<mesh::QualityFilter> filter_;  // of the mesh, if it is improved
};

}  // namespace eses::detail
