#include "run/merge.hpp"

#include <utility>

#include "eses/error.hpp"
#include "output/mesh_writer.hpp"
#include "run/piece_bytes.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

[[noreturn]] void refuse_damaged(const PlaneRange& planes, const PlannedRun& run) {
  run.checkpoint->drop(planes);
  throw Error(
      formatted("cannot resume: the checkpoint of planes {} to {} is damaged; the next run "
                "that is resumed computes them again",
                planes.begin, planes.end - 1));
}

}  // namespace

Merge::Merge(PlannedRun& run, std::function<void()> check) : run_(run), check_(std::move(check)) {
  std::int64_t next = run_.plan.tiling.region.begin[2];
  sums_.atom_shares.resize(run_.atoms);
  for (const PlaneRange& planes : run_.checkpoint->complete()) {
    PlaneChunk& chunk = chunks_.emplace_back(run_.checkpoint->read(planes));
    const ChunkInfo& info = chunk.info;
    if (info.planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = info.planes.end;
    sums_.add(info.sums);
    for (const AtomSum& sum : std::exchange(chunk.atom_sums, {}))
      sums_.atom_shares.at(as_number(sum.atom)) += sum.share;
  }
  if (next != run_.plan.tiling.region.end[2]) throw Error("chunks of the run are missing");
  mesh::require_vertex_count(sums_.mesh.vertices);
}

void Merge::replay(Sink& sink) {
  const GridRegion& region = run_.plan.tiling.region;
  std::uint64_t first_vertex = 0;
  Piece piece;
  for (const auto& [info, atom_sums] : chunks_) {
    const ScratchFile file = run_.checkpoint->open(info.planes);
    for (std::uint64_t offset = 0; offset < info.bytes; offset += length_of(piece.head)) {
      check_();
      if (!read_piece(file, offset, info.bytes, piece)) refuse_damaged(info.planes, run_);
      // The chunk counts rows and vertices from its own first ones; vertices below it have negative
      // numbers, modulo 2^64.
      piece.first_row += (info.planes.begin - region.begin[2]) * region.size()[1];
      for (mesh::Triangle& triangle : piece.mesh.triangles)
        for (std::uint64_t& vertex : triangle) vertex += first_vertex;
      sink.prepare(piece);
      sink.place(piece);
      sink.store(piece);
    }
    first_vertex += info.sums.mesh.vertices;
  }
}

}  // namespace eses::detail
