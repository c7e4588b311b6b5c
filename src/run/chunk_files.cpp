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

ChunkFiles::ChunkFiles(Checkpoint& checkpoint, const Outputs& outputs, const GridRegion& region)
    : checkpoint_(checkpoint), region_(region) {
  chunk_.info.planes = {region.begin[2], region.end[2]};
  if (outputs.grid)
    sinks_.add(std::make_unique<PieceTextSink>(&Piece::grid, create(ChunkText::grid)));
  if (outputs.edges)
    sinks_.add(std::make_unique<PieceTextSink>(&Piece::edges, create(ChunkText::edges)));
  if (outputs.mesh) sinks_.add(std::make_unique<MeshIntoChunk>(create(ChunkText::mesh)));
  for (const MapChoice& map : chosen_maps(outputs)) add_map(map.quantity);
}

// Creates the file of a text. Returns a function that writes it.
WriteAt ChunkFiles::create(ChunkText text) {
  std::unique_ptr<ScratchFile>& file = chunk_.text(text);
  file = checkpoint_.create(chunk_.info.planes, text);
  TextChecksum& checksum = checksums_[static_cast<std::size_t>(text)];
  return [&to = *file, &checksum](std::span<const char> bytes, std::uint64_t offset) {
    to.write_at(bytes, offset);
    checksum.add(bytes, offset);
  };
}

// The words of rows are converted to values of the map when chunks are merged.
void ChunkFiles::add_map(MapQuantity quantity) {
  const auto row_bytes = sizeof(std::uint64_t) * static_cast<std::uint64_t>(GridMap::words_of_row(
                                                     quantity, region_.size()));
  sinks_.add(std::make_unique<MapSink>(
      quantity, [row_bytes, write_at = create(text_of(quantity))](
                    std::int64_t first_row, std::span<const std::uint64_t> words) {
        write_at(as_chars(words), row_bytes * static_cast<std::uint64_t>(first_row));
      }));
}

void ChunkFiles::finish(const SweepSums& sums, const Slab& slab) {
  ChunkInfo& info = chunk_.info;
  info.sums = sums;
  for (std::size_t text = 0; text < chunk_text_count; ++text) {
    if (chunk_.texts[text]) info.bytes[text] = chunk_.texts[text]->size();
    info.checksums[text] = checksums_[text].value();
  }
  slab.for_each_sum(sums.atom_shares, [&](const AtomSum& sum) { chunk_.atom_sums.push_back(sum); });
  checkpoint_.finish(chunk_);
}

}  // namespace eses::detail
