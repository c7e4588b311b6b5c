#pragma once
/// Step 3 of a run: merging the chunks of all processes into the output files, by one process.

#include <cstdint>
#include <functional>
#include <vector>

#include "output/grid_map.hpp"
#include "output/output_file.hpp"
#include "run/checkpoint.hpp"
#include "run/run_mesh.hpp"
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
  /// Adds the pieces of all chunks to the mesh.
  void add_pieces(RunMesh& mesh);
  /// Adds the rows of all chunks to a map.
  void add_rows(GridMap& map);

  /// These functions complete a file and return its length in bytes.
  std::uint64_t write_text(OutputFile& file, ChunkText text);

 private:
  void add_up();
  ScratchFile& open(PlaneChunk& chunk, ChunkText text) const;
  void close(PlaneChunk& chunk, ChunkText text) const;
  template <class Take>
  void read(PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const;
  void require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const;
  void copy(PlaneChunk& chunk, ChunkText text, OutputFile& to, std::uint64_t begin) const;

  const RunTask& task_;
  const RunPlan& plan_;
  std::function<void()> check_;
  std::vector<PlaneChunk> chunks_;  // sorted by planes
  RegionTotals totals_;
};

}  // namespace eses::detail
