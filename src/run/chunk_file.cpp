#include "run/chunk_file.hpp"

#include "run/piece_bytes.hpp"

namespace eses::detail {

ChunkFile::ChunkFile(PlannedRun& run, const PlaneRange& planes)
    : run_(run), file_(run.checkpoint->create(planes)) {
  chunk_.info.planes = planes;
}

void ChunkFile::prepare(Piece& piece) { piece.head = head_of(piece); }

void ChunkFile::place(Piece& piece) {
  piece.offset_in_chunk = chunk_.info.bytes;
  chunk_.info.bytes += length_of(piece.head);
}

void ChunkFile::store(const Piece& piece) { write_piece(piece, file_, piece.offset_in_chunk); }

void ChunkFile::finish(const SweepSums& sums) {
  file_.sync();
  chunk_.info.sums = sums;
  run_.slab.for_each_sum(sums.atom_shares,
                         [&](const AtomSum& sum) { chunk_.atom_sums.push_back(sum); });
  run_.checkpoint->finish(chunk_);
}

}  // namespace eses::detail
