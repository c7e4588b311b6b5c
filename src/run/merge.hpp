#pragma once
/// Step 3 of a run: merging the chunks of all processes into the output files, by one process.

#include <cstdint>
#include <functional>
#include <vector>

#include "output/grid_map.hpp"
#include "output/output_file.hpp"
#include "run/checkpoint.hpp"
#include "run/planned_run.hpp"
#include "run/run_mesh.hpp"

namespace eses::detail {

/// The merge of all chunks of a checkpoint.
class Merge {
 public:
  /// Reads the sums of all chunks. `check` is called repeatedly, and may end the run by an
  /// exception. Keeps a reference to `run`. Throws Error if the chunks do not cover the region
  /// exactly, or if the mesh has too many vertices.
  Merge(PlannedRun& run, std::function<void()> check);

  /// The sums of all chunks, with the area share of each atom of the file.
  SweepSums& sums() { return sums_; }
  /// Adds the pieces of all chunks to the mesh.
  void add_pieces(RunMesh& mesh);
  /// Adds the rows of all chunks to a map.
  void add_rows(GridMap& map);
  /// Copies the texts of all chunks to a file.
  void write_text(OutputFile& file, ChunkText text);

 private:
  template <class Take>
  void read(const PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const;
  void require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const;

  PlannedRun& run_;
  std::function<void()> check_;
  std::vector<PlaneChunk> chunks_;  // sorted by planes
  SweepSums sums_;
};

}  // namespace eses::detail
