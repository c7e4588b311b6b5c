#pragma once
/// The files of a chunk of planes during a sweep.

#include <array>
#include <cstdint>

#include "eses/outputs.hpp"
#include "grid/tiling.hpp"
#include "run/checkpoint.hpp"
#include "run/sink.hpp"
#include "run/slabs.hpp"

namespace eses::detail {

/// A chunk that a sweep writes into a checkpoint. It is complete after `finish`.
class ChunkFiles {
 public:
  /// Creates the files. `region` has the points of the chunk. Keeps a reference to `checkpoint`.
  ChunkFiles(Checkpoint& checkpoint, const Outputs& outputs, const GridRegion& region);

  /// The sink of the sweep over the region.
  Sink& sink() { return sinks_; }
  /// Writes the sums of the chunk, which makes it complete. Closes its files, as the number of open
  /// files is limited.
  void finish(const SweepSums& sums, const Slab& slab);

 private:
  WriteAt create(ChunkText text);
  void add_map(MapQuantity quantity);

  Checkpoint& checkpoint_;
  GridRegion region_;
  PlaneChunk chunk_;
  std::array<TextChecksum, chunk_text_count> checksums_;
  Sinks sinks_;
};

}  // namespace eses::detail
