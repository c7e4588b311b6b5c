#pragma once
/// Step 3 of a run: merging the chunks of all processes into the output files.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "distributed/checkpoint.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_file.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_file.hpp"
#include "run/quality_pass.hpp"
#include "run/run_plan.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// The merge of all chunks. All processes must call its functions. The first process passes the
/// output file, the others pass null. A run in place has one chunk. Most of its texts are already
/// in the output files.
class Merge {
 public:
  /// `chunks` are the chunks of this process. `check` is called repeatedly, and may end the run by
  /// an exception. Keeps references to the other arguments. Throws SharedError if the chunks of all
  /// processes do not cover the region exactly, or if the mesh has too many vertices.
  Merge(const RunTask& task, const RunPlan& plan, const Processes& processes,
        std::vector<PlaneChunk> chunks, std::function<void()> check);

  const RegionTotals& totals() const { return totals_; }
  const MeshCounts& mesh_counts() const { return mesh_; }

  /// Improves the triangles of the mesh before `write_mesh`. Returns their angles. It is not called
  /// if the sweep has improved the mesh.
  MeshQuality improve_mesh(const mesh::MeshText& text);

  /// These functions complete a file and return its length in bytes.
  std::uint64_t write_text(OutputFile* file, ChunkText text);
  std::uint64_t write_map(OutputFile* file, const MapChoice& choice);
  /// `face_file` is the separate file of the triangles, if the format has one.
  std::uint64_t write_mesh(OutputFile* file, OutputFile* face_file, const mesh::MeshText& text);

 private:
  // A chunk of any process. Only the process that has swept or read it has its texts.
  struct MergedChunk : PlaneChunk {
    MeshCounts before;  // vertices and triangles of the chunks before it
  };
  using Chunks = std::vector<MergedChunk>;  // of all processes, sorted by planes

  // Chunks with the texts of the mesh.
  Chunks& mesh_chunks() { return improved_.empty() ? chunks_ : improved_; }
  bool is_here(const PlaneChunk& chunk) const {
    return chunk.info.rank == static_cast<std::uint32_t>(processes_.rank());
  }
  void add_up();
  int threads_of_shared_file() const;
  std::uint64_t write_values(GridMap& map) const;
  std::uint64_t write_compressed_values(GridMap& map, SharedFile& to) const;
  ScratchFile& open(PlaneChunk& chunk, ChunkText text) const;
  void close(PlaneChunk& chunk, ChunkText text) const;
  template <class Take>
  void read(PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const;
  void require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const;
  void copy(PlaneChunk& chunk, ChunkText text, SharedFile& to, std::uint64_t begin) const;
  std::uint64_t copy_all(Chunks& chunks, ChunkText text, SharedFile& to, std::uint64_t begin) const;
  template <class Take>
  void for_triangles(MergedChunk& chunk, Take&& take) const;
  template <class Take>
  void for_triangle_texts(MergedChunk& chunk, const mesh::MeshText& text, Take&& take) const;
  void stream_mesh(std::optional<QualityPass>& pass);
  std::uint64_t write_header(SharedFile& file, const mesh::MeshText& text,
                             const mesh::VertexBox& box = {}) const;
  void write_vertex_box(SharedFile& file, std::uint64_t begin, const mesh::MeshText& text);
  std::uint64_t write_triangles(SharedFile& file, std::uint64_t begin, const mesh::MeshText& text);
  std::uint64_t write_columns(SharedFile& file, std::uint64_t begin, const mesh::MeshText& text);

  const RunTask& task_;
  const RunPlan& plan_;
  const Processes& processes_;
  std::function<void()> check_;
  Chunks chunks_;
  Chunks improved_;  // the improved mesh as a single chunk, which the first process has
  RegionTotals totals_;
  MeshCounts mesh_;
};

}  // namespace eses::detail
