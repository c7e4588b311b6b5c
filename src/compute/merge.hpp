#pragma once
/// Step 3 of a run: the chunks of all processes become the files. What is in place already stays
/// there.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "compute/run_plan.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_file.hpp"
#include "mesh/mesh_writer.hpp"
#include "output/output_file.hpp"
#include "sweep/region_totals.hpp"

namespace eses::detail {

/// All functions are to be called by all processes. Only the first process has an output file; the
/// others pass null.
class Merge {
 public:
  /// Keeps references to all but `check`, which is called now and then, and may end the run by an
  /// exception. Takes the chunks of this process. Throws SharedError if the chunks of all processes
  /// are not those of the whole run, or if the mesh would have too many vertices.
  Merge(const RunTask& task, const RunPlan& plan, const Processes& processes,
        std::vector<PlaneChunk> chunks, std::function<void()> check);

  const RegionTotals& totals() const { return totals_; }
  const MeshCounts& mesh_counts() const { return mesh_; }

  /// Each of these completes a file and returns its length.
  std::uint64_t write_text(OutputFile* file, ChunkText text);
  std::uint64_t write_map(OutputFile* file);
  std::uint64_t write_mesh(OutputFile* file, const mesh::MeshText& text);

 private:
  void add_up();
  template <class Amount, class Action>
  std::uint64_t for_own(Amount&& amount, Action&& action);
  ScratchFile& open(PlaneChunk& chunk, ChunkText text) const;
  void close(PlaneChunk& chunk, ChunkText text) const;
  template <class Take>
  void read(PlaneChunk& chunk, ChunkText text, std::uint64_t unit, std::uint64_t begin,
            Take&& take) const;
  void require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const;
  std::uint64_t copy_in_kernel(PlaneChunk& chunk, ChunkText text, SharedFile& to,
                               std::uint64_t begin);
  void copy(PlaneChunk& chunk, ChunkText text, SharedFile& to, std::uint64_t begin);
  std::uint64_t copy_all(ChunkText text, SharedFile& to, std::uint64_t begin);
  template <class Take>
  void for_triangle_texts(PlaneChunk& chunk, std::uint64_t first_vertex, const mesh::MeshText& text,
                          Take&& take) const;
  std::uint64_t write_triangles(SharedFile& file, std::uint64_t begin, const mesh::MeshText& text);

  const RunTask& task_;
  const RunPlan& plan_;
  const Processes& processes_;
  std::function<void()> check_;
  std::vector<ChunkInfo> all_;   // of all processes, by planes
  std::vector<PlaneChunk> own_;  // by planes
  RegionTotals totals_;
  MeshCounts mesh_;
};

}  // namespace eses::detail
