#include "run/mesh_sinks.hpp"

#include "run/piece_bytes.hpp"

namespace eses::detail {

void MeshIntoFilter::take(std::int64_t index, mesh::MeshPiece& piece,
                          mesh::MeshFile::Scratch& /*scratch*/) {
  in_turn_.pass(index, piece,
                piece.vertices.size() * sizeof(mesh::FileVertex) +
                    piece.triangles.size() * sizeof(mesh::Triangle));
}

void MeshIntoChunk::take(std::int64_t index, mesh::MeshPiece& piece,
                         mesh::MeshFile::Scratch& scratch) {
  scratch.resize(1);
  scratch.front().clear();
  append_piece(scratch.front(), piece);
  output_.write(index, scratch.front().text());
}

}  // namespace eses::detail
