#include "run/chunk_files.hpp"

#include <memory>
#include <span>
#include <utility>

#include "output/grid_map.hpp"
#include "run/piece_bytes.hpp"

namespace eses::detail {
namespace {

// Writes the mesh, see append_piece.
class MeshIntoChunk final : public PieceTextSink {
 public:
  explicit MeshIntoChunk(WriteAt write_at)
      : PieceTextSink(&Piece::mesh_bytes, std::move(write_at)) {}
  void prepare(Piece& piece) override {
    piece.mesh_bytes.buffer.clear();
    append_piece(piece.mesh_bytes.buffer, piece.mesh);
  }
};

}  // namespace

ChunkFiles::ChunkFiles(PlannedRun& run, const PlaneRange& planes) : run_(run) {
  const Outputs& outputs = run.request.outputs;
  chunk_.info.planes = planes;
  if (outputs.grid)
    sinks_.add(std::make_unique<PieceTextSink>(&Piece::grid, create(ChunkText::grid)));
  if (outputs.edges)
    sinks_.add(std::make_unique<PieceTextSink>(&Piece::edges, create(ChunkText::edges)));
  if (outputs.mesh) sinks_.add(std::make_unique<MeshIntoChunk>(create(ChunkText::mesh)));
  for (const MapChoice& map : chosen_maps(outputs)) add_map(map.quantity);
}

// Creates the file of a text. Returns a function that writes it.
WriteAt ChunkFiles::create(ChunkText which) {
  Text& text = texts_[static_cast<std::size_t>(which)];
  text.file = run_.checkpoint->create(chunk_.info.planes, which);
  return [&text](std::span<const char> bytes, std::uint64_t offset) {
    text.file->write_at(bytes, offset);
    text.checksum.add(bytes, offset);
  };
}

// The words of rows are converted to values of the map when chunks are merged.
void ChunkFiles::add_map(MapQuantity quantity) {
  const std::uint64_t row_bytes = GridMap::row_bytes(quantity, run_.plan.tiling.region.size());
  sinks_.add(std::make_unique<MapSink>(
      quantity, [row_bytes, write_at = create(text_of(quantity))](
                    std::int64_t first_row, std::span<const std::uint64_t> words) {
        write_at(as_chars(words), row_bytes * static_cast<std::uint64_t>(first_row));
      }));
}

void ChunkFiles::finish(const SweepSums& sums) {
  ChunkInfo& info = chunk_.info;
  info.sums = sums;
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    if (!texts_[i].file) continue;
    texts_[i].file->sync();
    info.bytes[i] = texts_[i].file->size();
    info.checksums[i] = texts_[i].checksum.value();
  }
  run_.slab.for_each_sum(sums.atom_shares,
                         [&](const AtomSum& sum) { chunk_.atom_sums.push_back(sum); });
  run_.checkpoint->finish(chunk_);
}

}  // namespace eses::detail
