#pragma once
/// Chunks of planes on disk: their pieces, the sink that writes a chunk, and the merge of all
/// chunks into the output files.

#include <cstdint>
#include <functional>
#include <vector>

#include "output/file.hpp"
#include "run/checkpoint.hpp"
#include "run/piece.hpp"
#include "run/planned_run.hpp"
#include "run/sink.hpp"
#include "run/sweep.hpp"

namespace eses::detail {

/// Returns the head of a piece.
PieceHead head_of(const RowPiece& piece);

/// Returns the length of a piece in bytes, with its head.
std::uint64_t length_of(const PieceHead& head);

/// Writes a piece, whose head is set, at an offset of a file.
void write_piece(const RowPiece& piece, File& file, std::uint64_t offset);

/// Reads the piece at an offset of a file that ends at `end`. Returns false if it is damaged.
bool read_piece(const File& file, std::uint64_t offset, std::uint64_t end, RowPiece& piece);

/// A chunk that a sweep writes into a checkpoint, piece by piece. It is complete after `finish`.
class ChunkFile final : public Sink {
 public:
  /// Creates the file of a chunk of these planes. Keeps a reference to `run`.
  ChunkFile(PlannedRun& run, const PlaneRange& planes);

  void prepare(RowPiece& piece) override;
  void place(RowPiece& piece) override;
  void store(const RowPiece& piece) override;

  /// Writes the sums of the chunk, which makes it complete.
  void finish(const SweepSums& sums);

 private:
  PlannedRun& run_;
  PlaneChunk chunk_;
  ScratchFile file_;
};

/// The chunks of a checkpoint, all together.
class Merge {
 public:
  /// Reads the sums of all chunks. `check` is called repeatedly, and may end the run by an
  /// exception. Keeps a reference to `run`. Throws Error if the chunks do not cover the region
  /// exactly, or if the mesh has too many vertices.
  Merge(PlannedRun& run, std::function<void()> check);

  /// The sums of all chunks, with the area share of each atom of the file.
  SweepSums& sums() { return sums_; }
  /// Passes the pieces of all chunks to a sink, as one sweep over the region would. Throws Error if
  /// a chunk is damaged.
  void replay(Sink& sink);

 private:
  PlannedRun& run_;
  std::function<void()> check_;
  std::vector<PlaneChunk> chunks_;  // sorted by planes
  SweepSums sums_;
};

}  // namespace eses::detail
