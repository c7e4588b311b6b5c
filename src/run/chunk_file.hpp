#pragma once
/// The file of a chunk of planes during a sweep.

#include "run/checkpoint.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"

namespace eses::detail {

/// A chunk that a sweep writes into a checkpoint, piece by piece. It is complete after `finish`.
class ChunkFile final : public Sink {
 public:
  /// Creates the file of a chunk of these planes. Keeps a reference to `run`.
  ChunkFile(PlannedRun& run, const PlaneRange& planes);

  void prepare(Piece& piece) override;
  void place(Piece& piece) override;
  void store(const Piece& piece) override;

  /// Writes the sums of the chunk, which makes it complete.
  void finish(const SweepSums& sums);

 private:
  PlannedRun& run_;
  PlaneChunk chunk_;
  ScratchFile file_;
};

}  // namespace eses::detail
