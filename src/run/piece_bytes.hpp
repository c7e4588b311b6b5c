#pragma once
/// Pieces as bytes in a file, for the chunks of planes on disk: a head, and the lists of the piece
/// as they are in memory.

#include <cstdint>

#include "mesh/piece.hpp"
#include "output/file.hpp"
#include "run/piece.hpp"

namespace eses::detail {

/// Returns the head of a piece.
PieceHead head_of(const Piece& piece);

/// Returns the length of a piece in bytes, with its head.
std::uint64_t length_of(const PieceHead& head);

/// Writes a piece, whose head is set, at an offset of a file.
void write_piece(const Piece& piece, File& file, std::uint64_t offset);

/// Reads the piece at an offset of a file that ends at `end`. Returns false if it is damaged.
bool read_piece(const File& file, std::uint64_t offset, std::uint64_t end, Piece& piece);

/// Typical size in bytes of a vertex and its two triangles.
double piece_bytes_per_vertex(const mesh::PieceContents& contents);

}  // namespace eses::detail
