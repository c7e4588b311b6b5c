#include "run/piece_bytes.hpp"

#include <cstddef>
#include <span>
#include <vector>

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

std::uint32_t checksum_of_lists(const Piece& piece) {
  std::uint32_t sum = 0;
  for_each_list(piece, piece.head,
                [&](const auto& list, auto&) { sum = checksum(bytes_of(list), sum); });
  return sum;
}

}  // namespace

PieceHead head_of(const Piece& piece) {
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

void write_piece(const Piece& piece, File& file, std::uint64_t offset) {
  const auto write = [&](std::span<const char> bytes) {
    if (!bytes.empty()) file.write_at(bytes, offset);
    offset += bytes.size();
  };
  write(as_chars(std::span(&piece.head, 1)));
  for_each_list(piece, piece.head, [&](const auto& list, auto&) { write(bytes_of(list)); });
}

bool read_piece(const File& file, std::uint64_t offset, std::uint64_t end, Piece& piece) {
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

double piece_bytes_per_vertex(const mesh::PieceContents& contents) {
  const std::size_t triangle = sizeof(mesh::Triangle) + (contents.triangle_patches ? 1 : 0) +
                               (contents.corners ? sizeof(mesh::TrianglePoints) : 0);
  return static_cast<double>((contents.vertices ? sizeof(mesh::FileVertex) : 0) + 2 * triangle);
}

}  // namespace eses::detail
