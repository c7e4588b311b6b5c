#pragma once
/// Step 2 of a run: the sweep over the planes of this process, range by range. The rows, crossings
/// and triangles of a range are written to the output files directly, or to a chunk. In a run that
/// writes directly, the sweep also improves the triangles of a mesh with MeshOptions::quality.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "distributed/checkpoint.hpp"
#include "distributed/processes.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_files.hpp"
#include "run/mesh_output.hpp"
#include "run/pipeline.hpp"
#include "run/progress_report.hpp"
#include "run/quality_pass.hpp"
#include "run/run_plan.hpp"
#include "run/verifier.hpp"
#include "surface/patch_schedule.hpp"

namespace eses::detail {

/// Returns the ranges of planes that this process sweeps, ascending. A run that can be resumed has
/// several ranges, as an interruption loses the current range.
std::vector<PlaneRange> ranges_to_sweep(const RunTask& task, const RunPlan& plan);

/// Returns the number of blocks in these ranges.
std::int64_t count_blocks(const RunPlan& plan, std::span<const PlaneRange> ranges);

/// The files of a sweep.
struct SweepFiles {
  OutputFiles* final_files = nullptr;   ///< output files; null if chunks are written
  std::uint64_t mesh_header_bytes = 0;  ///< offset of the vertices in the mesh file
  std::uint64_t face_header_bytes = 0;  ///< offset of the triangles if they have their own file
  const mesh::MeshText* mesh_text = nullptr;  ///< null without a mesh
};

/// The result of a sweep.
struct SweepResult {
  std::vector<PlaneChunk> chunks;
  std::vector<AreaShare> atom_shares;       ///< area share of each atom of the slab; empty if none
  std::optional<MeshQuality> mesh_quality;  ///< if the sweep has improved the mesh
};

/// Sweeps the planes of this process's slab.
class SlabSweep {
 public:
  /// Keeps references to all arguments except `files` and `processes`.
  SlabSweep(const RunTask& task, const RunPlan& plan, std::span<const PlaneRange> ranges,
            const SweepFiles& files, const Callbacks& callbacks, ProgressReport& report,
            const Processes& processes);

  /// Sweeps all ranges. Adds their times and the results of the verification to the summary. A
  /// chunk with faults is not kept in the checkpoint.
  SweepResult run(Summary& summary);

 private:
  // Checksums of the texts of a chunk in a checkpoint.
  using Checksums = std::array<TextChecksum, chunk_text_count>;

  Plan plan_of(const PlaneRange& planes) const;
  std::int64_t check_count_of(const PlaneRange& planes) const;
  SurfaceModel make_surface() const;
  ComponentOfCrossing component_of_crossing() const;
  PlaneChunk new_chunk(const PlaneRange& planes) const;
  bool is_written_in_place(ChunkText text) const;
  OrderedOutput::WriteAt sink_of_text(ChunkText text, PlaneChunk& chunk,
                                      Checksums& checksums) const;
  MeshSinks mesh_sinks(PlaneChunk& chunk, Checksums& checksums,
                       std::optional<QualityPass>& pass) const;
  std::vector<MapSink> map_sinks(PlaneChunk& chunk, const GridRegion& region,
                                 Checksums& checksums) const;
  PlaneChunk sweep(PatchSchedule& patches, const PlaneRange& planes, SweepResult& result,
                   Summary& summary);
  bool verify(Verifier& verifier, Summary& summary);
  void save_chunk(PlaneChunk& chunk, const Checksums& checksums,
                  std::span<const AreaShare> shares) const;

  const RunTask& task_;
  const RunPlan& plan_;
  std::span<const PlaneRange> ranges_;
  SweepFiles files_;
  const Callbacks& callbacks_;
  ProgressReport& report_;
  bool is_in_place_;
  std::int64_t check_count_;  // number of points, and of edges, that this process verifies
};

}  // namespace eses::detail
