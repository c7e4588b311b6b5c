#pragma once
/// Pieces of a mesh as bytes, for the chunks of planes on disk.

#include <functional>
#include <span>
#include <vector>

#include "mesh/piece.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail {

/// Appends a piece whose vertices are numbered from the first one of its chunk; vertices below the
/// chunk have negative numbers, modulo 2^64. A piece without vertices and triangles appends
/// nothing.
void append_piece(TextBuffer& bytes, const mesh::MeshPiece& piece);

/// Typical size in bytes of a vertex and its two triangles.
double piece_bytes_per_vertex(const mesh::PieceContents& contents);

/// Reads pieces from their bytes, which arrive in parts of any length.
class PieceReader {
 public:
  using Take = std::function<void(const mesh::MeshPiece& piece)>;

  /// `first_vertex` is the number of the first vertex of the chunk in the whole mesh.
  PieceReader(std::uint64_t first_vertex, Take take)
      : first_vertex_(first_vertex), take_(std::move(take)) {}

  void add(std::span<const char> bytes);

 private:
  std::size_t add_piece(std::span<const char> bytes);

  std::uint64_t first_vertex_;
  Take take_;
  std::vector<char> rest_;  // the beginning of a piece that is not complete
  mesh::MeshPiece piece_;
};

}  // namespace eses::detail
