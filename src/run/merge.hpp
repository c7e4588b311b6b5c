#pragma once
/// Step 3 of a run: merging the chunks of all processes into the output files, by one process.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "output/grid_map.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_file.hpp"
#include "run/checkpoint.hpp"
#include "run/quality_pass.hpp"
#include "run/run_plan.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// The merge of all chunks. A run in place has one chunk, most of whose texts are already in the
/// output files.
class Merge {
 public:
  /// `check` is called repeatedly, and may end the run by an exception. Keeps references to the
  /// other arguments. Throws Error if the chunks do not cover the region exactly, or if the mesh
  /// has too many vertices.
  Merge(const RunTask& task, const RunPlan& plan, std::vector<PlaneChunk> chunks,
        std::function<void()> check);

  const RegionTotals& totals() const { return totals_; }
  const MeshCounts& mesh_counts() const { return mesh_; }

  /// Improves the triangles of the mesh before `write_mesh`. Returns their angles. It is not called
  /// if the sweep has improved the mesh.
  MeshQuality improve_mesh(const mesh::MeshText& text);

  /// These functions complete a file and return its length in bytes.
  std::uint64_t write_text(OutputFile& file, ChunkText text);
  std::uint64_t write_map(OutputFile& file, const MapChoice& choice);
  /// `face_file` is the separate file of the triangles, or null.
  std::uint64_t write_mesh(OutputFile& file, OutputFile* face_file, const mesh::MeshText& text);

 private:
  struct MergedChunk : PlaneChunk {
    MeshCounts before;  // vertices and triangles of the chunks before it
  };
  using Chunks = std::vector<MergedChunk>;  // sorted by planes

  // Chunks with the texts of the mesh.
  Chunks& mesh_chunks() { return improved_.empty() ? chunks_ : improved_; }
  void add_up();
  std::uint64_t write_compressed_values(GridMap& map, OutputFile& to) const;
  ScratchFile& open(PlaneChunk& chunk, ChunkText text) const;
  void close(PlaneChunk& chunk, ChunkText text) const;
  template <class Take>
  void read(PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const;
  void require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const;
  void copy(PlaneChunk& chunk, ChunkText text, OutputFile& to, std::uint64_t begin) const;
  std::uint64_t copy_all(Chunks& chunks, ChunkText text, OutputFile& to, std::uint64_t begin) const;
  template <class Take>
  void for_triangles(MergedChunk& chunk, Take&& take) const;
  template <class Take>
  void for_triangle_texts(MergedChunk& chunk, const mesh::MeshText& text, Take&& take) const;
  std::uint64_t write_header(OutputFile& file, const mesh::MeshText& text,
                             const mesh::VertexBox& box = {}) const;
  void write_vertex_box(OutputFile& file, std::uint64_t begin, const mesh::MeshText& text);
  std::uint64_t write_triangles(OutputFile& file, std::uint64_t begin, const mesh::MeshText& text);
  std::uint64_t write_columns(OutputFile& file, std::uint64_t begin, const mesh::MeshText& text);

  const RunTask& task_;
  const RunPlan& plan_;
  std::function<void()> check_;
  Chunks chunks_;
  Chunks improved_;  // the improved mesh as a single chunk
  RegionTotals totals_;
  MeshCounts mesh_;
};

}  // namespace eses::detail
