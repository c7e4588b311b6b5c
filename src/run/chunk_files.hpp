#pragma once
/// The files of a chunk of planes during a sweep.

#include <array>
#include <cstdint>
#include <memory>

#include "run/checkpoint.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// A chunk that a sweep writes into a checkpoint. It is complete after `finish`.
class ChunkFiles {
 public:
  /// Creates the files of a chunk of these planes. Keeps a reference to `run`.
  ChunkFiles(PlannedRun& run, const PlaneRange& planes);

  /// The sink of the sweep over the region.
  Sink& sink() { return sinks_; }
  /// Writes the sums of the chunk, which makes it complete.
  void finish(const SweepSums& sums);

 private:
  struct Text {
    std::unique_ptr<ScratchFile> file;  // null if the chunk does not have the text
    TextChecksum checksum;
  };

  WriteAt create(ChunkText which);
  void add_map(MapQuantity quantity);

  PlannedRun& run_;
  PlaneChunk chunk_;
  std::array<Text, chunk_text_count> texts_;
  Sinks sinks_;
};

}  // namespace eses::detail
