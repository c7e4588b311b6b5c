#pragma once
/// The bytes of mesh files.
///
/// PLY: G. Turk, https://paulbourke.net/dataformats/ply/
/// OBJ: https://paulbourke.net/dataformats/obj/
/// OFF: http://www.geomview.org/docs/html/OFF.html

#include <array>
#include <cstdint>
#include <span>

#include "io/eses_writer.hpp"
#include "io/text_pieces.hpp"
#include "mesh/atom_groups.hpp"
#include "mesh/mesh_format.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::detail::mesh {

/// Throws Error if there are more vertices than readers of such files can number.
void require_numbers(std::uint64_t vertices);

/// A file is the header, all vertices, all triangles.
class MeshText {
 public:
  /// `atom_numbers` are what atoms are called, by index, or empty if that is their index. They and
  /// the numbers of groups must outlive this.
  MeshText(MeshFormat format, MeshColor color, AtomGroups groups,
           std::span<const AtomIndex> atom_numbers = {});

  /// The header before and behind the lines that name chains and residues, which only PLY has. Both
  /// parts have the same length whatever the counts.
  void write_header_begin(const TextSink& sink) const;
  void write_header_end(const MeshCounts& counts, const TextSink& sink) const;
  void append_vertex(TextBuffer& text, const Vertex& vertex) const;
  void append_triangle(TextBuffer& text, const Triangle& triangle) const;

 private:
  void append_ply_end(TextPieces& text, const MeshCounts& counts) const;
  void append_ply_vertex(TextBuffer& text, const Vertex& vertex) const;
  std::array<std::uint8_t, 3> color_of(const Vertex& vertex) const;
  AtomIndex number_of(AtomIndex atom) const {
    return atom_numbers_.empty() ? atom : atom_numbers_[atom];
  }

  MeshFormat format_;
  MeshColor color_;
  AtomGroups groups_;
  std::span<const AtomIndex> atom_numbers_;
};

/// The lines in which a PLY header names chain and residue `number`.
void append_chain_name(TextPieces& text, std::uint64_t number, const AtomLabel& label);
void append_residue_name(TextPieces& text, std::uint64_t number, const AtomLabel& label);

/// Whether vertices have a chain and a residue, where these are known.
inline bool names_atoms(const MeshOptions& choice) {
  return mesh_format(choice.file) == MeshFormat::ply;
}

/// Of the line in which a header names a residue or chain, what is not the names.
inline constexpr std::uint64_t typical_name_line_bytes = 26;

/// Bytes of a vertex and of a triangle, typically.
std::uint64_t typical_vertex_bytes(const MeshOptions& choice, bool has_labels);
std::uint64_t typical_triangle_bytes(const MeshOptions& choice);

}  // namespace eses::detail::mesh
