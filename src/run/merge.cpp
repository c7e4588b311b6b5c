#include "run/merge.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "eses/error.hpp"
#include "output/grid_map.hpp"
#include "output/mesh_writer.hpp"
#include "run/piece_bytes.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Bytes that are read at a time. The run can end after each part.
constexpr std::uint64_t bytes_per_read = std::uint64_t{1} << 22;

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

void Merge::require_sound(const PlaneChunk& chunk, ChunkText text, std::uint32_t checksum) const {
  if (checksum == chunk.info.checksums[static_cast<std::size_t>(text)]) return;
  run_.checkpoint->drop(chunk.info.planes);
  throw Error(
      formatted("cannot resume: the checkpoint of planes {} to {} is damaged; the next run "
                "that is resumed computes them again",
                chunk.info.planes.begin, chunk.info.planes.end - 1));
}

// Calls `take(bytes, offset)` for parts of a chunk's text, whose lengths are multiples of `unit`.
// Throws Error at the end if the text is damaged. Closes its file, as the number of open files is
// limited.
template <class Take>
void Merge::read(const PlaneChunk& chunk, ChunkText text, std::uint64_t unit, Take&& take) const {
  const std::uint64_t length = chunk.info.bytes_of(text);
  if (length == 0) return;
  const std::uint64_t step = std::max<std::uint64_t>(1, bytes_per_read / unit) * unit;
  const std::unique_ptr<ScratchFile> file = run_.checkpoint->open(chunk.info.planes, text);
  TextChecksum checksum;
  std::vector<char> part;
  for (std::uint64_t offset = 0; offset < length; offset += part.size()) {
    check_();
    part.resize(std::min(step, length - offset));
    file->read_at(part, offset);
    checksum.add(part, offset);
    take(std::span<const char>(part), offset);
  }
  require_sound(chunk, text, checksum.value());
}

void Merge::write_text(OutputFile& file, ChunkText text) {
  for (const PlaneChunk& chunk : chunks_)
    read(chunk, text, 1, [&](std::span<const char> part, std::uint64_t) { file.append(part); });
}

void Merge::add_rows(GridMap& map) {
  const GridRegion& region = run_.plan.tiling.region;
  const ChunkText text = text_of(map.quantity());
  const std::uint64_t row_bytes = GridMap::row_bytes(map.quantity(), region.size());
  std::vector<std::uint64_t> words;
  for (const PlaneChunk& chunk : chunks_) {
    const std::int64_t first_row = (chunk.info.planes.begin - region.begin[2]) * region.size()[1];
    read(chunk, text, row_bytes, [&](std::span<const char> bytes, std::uint64_t offset) {
      words.resize(bytes.size() / sizeof(std::uint64_t));
      std::memcpy(words.data(), bytes.data(), bytes.size());
      map.add_rows(first_row + static_cast<std::int64_t>(offset / row_bytes), words);
    });
  }
}

void Merge::add_pieces(RunMesh& mesh) {
  std::uint64_t first_vertex = 0;
  for (const PlaneChunk& chunk : chunks_) {
    PieceReader reader(first_vertex, [&](const mesh::MeshPiece& piece) { mesh.add(piece); });
    read(chunk, ChunkText::mesh, 1,
         [&](std::span<const char> bytes, std::uint64_t) { reader.add(bytes); });
    first_vertex += chunk.info.sums.mesh.vertices;
  }
}

}  // namespace eses::detail
