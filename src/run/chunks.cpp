#include "run/chunks.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include "eses/error.hpp"
#include "output/mesh_formatter.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

std::span<const char> bytes_of(const TextBuffer& text) { return text.text(); }

template <class Value>
std::span<const char> bytes_of(const std::vector<Value>& list) {
  return as_chars(std::span(list));
}

// Gives a list this length in bytes. Returns its memory.
std::span<char> resize(TextBuffer& text, std::uint64_t bytes) {
  text.clear();
  char* const begin = text.reserve(bytes);
  text.advance_to(begin + bytes);
  return {begin, bytes};
}

template <class Value>
std::span<char> resize(std::vector<Value>& list, std::uint64_t bytes) {
  list.resize(bytes / sizeof(Value));
  return as_chars(std::span(list));
}

// Calls `visit` for the lists of a piece and their lengths, in the order of the file.
template <class SomePiece, class Head, class Visit>
void for_each_list(SomePiece& piece, Head& head, Visit&& visit) {
  std::size_t next = 0;
  visit(piece.grid.buffer, head.bytes[next++]);
  visit(piece.edges.buffer, head.bytes[next++]);
  for (auto& rows : piece.map_rows) {
    visit(rows.bits, head.bytes[next++]);
    visit(rows.partial_edges, head.bytes[next++]);
  }
  visit(piece.mesh.vertices, head.bytes[next++]);
  visit(piece.mesh.triangles, head.bytes[next++]);
  visit(piece.mesh.triangle_patches, head.bytes[next++]);
  visit(piece.mesh.corners, head.bytes[next++]);
}

std::uint32_t checksum_of(const PieceHead& head) {
  return checksum(as_chars(std::span(&head, 1)).subspan(sizeof head.checksum));
}

std::uint32_t checksum_of_lists(const RowPiece& piece) {
  std::uint32_t sum = 0;
  for_each_list(piece, piece.head,
                [&](const auto& list, auto&) { sum = checksum(bytes_of(list), sum); });
  return sum;
}

[[noreturn]] void refuse_damaged(const PlaneRange& planes, const PlannedRun& run) {
  run.checkpoint->drop(planes);
  throw Error(
      formatted("cannot resume: the checkpoint of planes {} to {} is damaged; the next run "
                "that is resumed computes them again",
                planes.begin, planes.end - 1));
}

}  // namespace

PieceHead head_of(const RowPiece& piece) {
  PieceHead head{.lists_checksum = checksum_of_lists(piece),
                 .first_row = piece.first_row,
                 .vertex_count = piece.mesh.vertex_count};
  for_each_list(piece, head,
                [](const auto& list, std::uint64_t& bytes) { bytes = bytes_of(list).size(); });
  head.checksum = checksum_of(head);
  return head;
}

std::uint64_t length_of(const PieceHead& head) {
  std::uint64_t length = sizeof head;
  for (const std::uint64_t bytes : head.bytes) length += bytes;
  return length;
}

void write_piece(const RowPiece& piece, File& file, std::uint64_t offset) {
  const auto write = [&](std::span<const char> bytes) {
    if (!bytes.empty()) file.write_at(bytes, offset);
    offset += bytes.size();
  };
  write(as_chars(std::span(&piece.head, 1)));
  for_each_list(piece, piece.head, [&](const auto& list, auto&) { write(bytes_of(list)); });
}

bool read_piece(const File& file, std::uint64_t offset, std::uint64_t end, RowPiece& piece) {
  PieceHead& head = piece.head;
  if (end - offset < sizeof head) return false;
  file.read_at(as_chars(std::span(&head, 1)), offset);
  offset += sizeof head;
  // A damaged head may have any lengths.
  if (head.checksum != checksum_of(head) || length_of(head) - sizeof head > end - offset)
    return false;
  piece.first_row = head.first_row;
  piece.mesh.vertex_count = head.vertex_count;
  for_each_list(piece, head, [&](auto& list, std::uint64_t bytes) {
    if (const std::span<char> memory = resize(list, bytes); !memory.empty())
      file.read_at(memory, offset);
    offset += bytes;
  });
  return head.lists_checksum == checksum_of_lists(piece);
}

ChunkFile::ChunkFile(PlannedRun& run, const PlaneRange& planes)
    : run_(run), file_(run.checkpoint->create(planes)) {
  chunk_.planes = planes;
}

void ChunkFile::prepare(RowPiece& piece) { piece.head = head_of(piece); }

void ChunkFile::place(RowPiece& piece) {
  piece.offset_in_chunk = chunk_.bytes;
  chunk_.bytes += length_of(piece.head);
}

void ChunkFile::store(const RowPiece& piece) { write_piece(piece, file_, piece.offset_in_chunk); }

void ChunkFile::finish(const SweepSums& sums) {
  file_.sync();
  chunk_.totals = sums.totals;
  const FileIndices file_indices = run_.slab.file_indices();
  for (AtomIndex i = 0; i < sums.atom_shares.size(); ++i)
    if (sums.atom_shares[i] != 0)
      chunk_.atom_sums.push_back({sums.atom_shares[i], file_indices[i]});
  run_.checkpoint->finish(chunk_);
}

Merge::Merge(PlannedRun& run, std::function<void()> check) : run_(run), check_(std::move(check)) {
  std::int64_t next = run_.plan.region.begin[2];
  sums_.atom_shares.resize(run_.input.atom_count);
  for (const PlaneRange& planes : run_.checkpoint->complete()) {
    PlaneChunk& chunk = chunks_.emplace_back(run_.checkpoint->read(planes));
    if (planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = planes.end;
    sums_.totals.add(chunk.totals);
    for (const AtomSum& sum : std::exchange(chunk.atom_sums, {}))
      sums_.atom_shares.at(as_number(sum.atom)) += sum.share;
  }
  if (next != run_.plan.region.end[2]) throw Error("chunks of the run are missing");
  mesh::require_vertex_count(sums_.totals.mesh.vertices);
}

void Merge::replay(Sink& sink) {
  const GridRegion& region = run_.plan.region;
  std::uint64_t first_vertex = 0;
  RowPiece piece;
  for (const PlaneChunk& chunk : chunks_) {
    const ScratchFile file = run_.checkpoint->open(chunk.planes);
    for (std::uint64_t offset = 0; offset < chunk.bytes; offset += length_of(piece.head)) {
      check_();
      if (!read_piece(file, offset, chunk.bytes, piece)) refuse_damaged(chunk.planes, run_);
      // The chunk counts rows and vertices from its own first ones; vertices below it have negative
      // numbers, modulo 2^64.
      piece.first_row += (chunk.planes.begin - region.begin[2]) * region.size()[1];
      for (mesh::Triangle& triangle : piece.mesh.triangles)
        for (std::uint64_t& vertex : triangle) vertex += first_vertex;
      sink.prepare(piece);
      sink.place(piece);
      sink.store(piece);
    }
    first_vertex += chunk.totals.mesh.vertices;
  }
}

}  // namespace eses::detail
