#include "run/piece_bytes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "output/file.hpp"

namespace eses::detail {
namespace {

// The lengths of the lists of a piece.
struct PieceHead {
  std::uint64_t vertex_count = 0, vertices = 0, triangles = 0, patches = 0, corners = 0;
};

// A triangle whose vertices are numbered from the first vertex of the chunk.
using ChunkTriangle = std::array<std::int32_t, 3>;

template <class Value>
void append(TextBuffer& bytes, std::span<const Value> values) {
  if (values.empty()) return;
  char* const out = bytes.reserve(values.size_bytes());
  std::memcpy(out, values.data(), values.size_bytes());
  bytes.advance_to(out + values.size_bytes());
}

template <class Value>
const char* read(const char* from, std::uint64_t count, std::vector<Value>& values) {
  values.resize(count);
  if (count > 0) std::memcpy(values.data(), from, count * sizeof(Value));
  return from + count * sizeof(Value);
}

std::size_t length_of(const PieceHead& head) {
  return sizeof head + head.vertices * sizeof(mesh::FileVertex) +
         head.triangles * sizeof(ChunkTriangle) + head.patches +
         head.corners * sizeof(mesh::TrianglePoints);
}

}  // namespace

void append_piece(TextBuffer& bytes, const mesh::MeshPiece& piece) {
  const PieceHead head{piece.vertex_count, piece.vertices.size(), piece.triangles.size(),
                       piece.triangle_patches.size(), piece.corners.size()};
  if (head.vertex_count == 0 && head.triangles == 0) return;
  append(bytes, std::span(&head, 1));
  append(bytes, std::span(piece.vertices));
  std::vector<ChunkTriangle> triangles;
  triangles.reserve(piece.triangles.size());
  for (const auto& [a, b, c] : piece.triangles)
    triangles.push_back(
        {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)});
  append(bytes, std::span<const ChunkTriangle>(triangles));
  append(bytes, std::span(piece.triangle_patches));
  append(bytes, std::span(piece.corners));
}

double piece_bytes_per_vertex(const mesh::PieceContents& contents) {
  const std::size_t triangle = sizeof(ChunkTriangle) + (contents.triangle_patches ? 1 : 0) +
                               (contents.corners ? sizeof(mesh::TrianglePoints) : 0);
  return static_cast<double>((contents.vertices ? sizeof(mesh::FileVertex) : 0) + 2 * triangle);
}

void PieceReader::add(std::span<const char> bytes) {
  if (!rest_.empty()) {
    const std::size_t length = rest_.size();
    rest_.resize(length + bytes.size());
    std::copy(bytes.begin(), bytes.end(), rest_.begin() + static_cast<std::ptrdiff_t>(length));
    bytes = rest_;
  }
  while (const std::size_t length = add_piece(bytes)) bytes = bytes.subspan(length);
  std::vector<char>(bytes.begin(), bytes.end()).swap(rest_);
}

// Takes the first piece of `bytes`, and returns its length, or 0 if it is not complete.
std::size_t PieceReader::add_piece(std::span<const char> bytes) {
  PieceHead head;
  if (bytes.size() < sizeof head) return 0;
  std::memcpy(&head, bytes.data(), sizeof head);
  // A damaged chunk may have any numbers here.
  if (std::max({head.vertices, head.triangles, head.patches, head.corners}) > bytes.size() ||
      bytes.size() < length_of(head))
    return 0;
  piece_.vertex_count = head.vertex_count;
  std::vector<ChunkTriangle> triangles;
  const char* next = read(bytes.data() + sizeof head, head.vertices, piece_.vertices);
  next = read(next, head.triangles, triangles);
  next = read(next, head.patches, piece_.triangle_patches);
  read(next, head.corners, piece_.corners);
  const auto number = [this](std::int32_t in_chunk) {
    return first_vertex_ + static_cast<std::uint64_t>(std::int64_t{in_chunk});
  };
  piece_.triangles.clear();
  for (const auto& [a, b, c] : triangles)
    piece_.triangles.push_back({number(a), number(b), number(c)});
  take_(piece_);
  return length_of(head);
}

}  // namespace eses::detail
