#pragma once
/// The bytes of mesh files.
///
/// PLY: G. Turk, https://paulbourke.net/dataformats/ply/
/// OBJ: https://paulbourke.net/dataformats/obj/
/// OFF: http://www.geomview.org/docs/html/OFF.html
/// MSMS: msms_text.hpp; VTP: vtp_text.hpp

#include <cstdint>
#include <span>
#include <string_view>

#include "io/eses_writer.hpp"
#include "io/text_pieces.hpp"
#include "mesh/atom_groups.hpp"
#include "mesh/mesh_format.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "mesh/vertex_color.hpp"
#include "mesh/vtp_text.hpp"

namespace eses::detail::mesh {

/// Throws Error if there are more vertices than readers of such files can number.
void require_numbers(std::uint64_t vertices);

/// What files tell besides vertices and triangles. Everything must outlive the MeshText.
struct MeshSource {
  AtomGroups groups;
  /// Numbers of the atoms in the input, by index; empty if they are the indices.
  std::span<const AtomIndex> atom_numbers;
  std::span<const Atom> atoms;   ///< by index
  std::uint64_t atom_count = 0;  ///< of the molecule
  double probe_radius = 0;       ///< angstrom
  double spacing = 0;            ///< angstrom
};

/// The texts of a mesh. Most formats have one file: a header, all vertices, all triangles. MSMS has
/// a header and the vertices in one file, a header and the triangles in another. In VTP, vertices
/// and triangles are records, which are divided into columns when all of them are there.
class MeshText {
 public:
  MeshText(MeshFormat format, MeshColor color, MeshSource source);

  /// Whether triangles have a file of their own.
  bool has_face_file() const { return format_ == MeshFormat::msms; }
  /// Whether vertices and triangles are divided into columns, as vtp_data() tells.
  bool has_columns() const { return format_ == MeshFormat::vtp; }
  /// Whether `append_triangle` needs the triangles' patches.
  bool has_triangle_patches() const { return format_ == MeshFormat::msms; }

  /// The header: its begin, the names of all chains, a part in the middle, the names of all
  /// residues, and its end. Names are there only in formats that name atoms. All parts have the
  /// same length whatever the counts.
  void write_header_begin(const TextSink& sink) const;
  void append_chain_name(TextPieces& text, std::uint64_t number, const AtomLabel& label) const;
  void write_header_middle(const TextSink& sink) const;
  void append_residue_name(TextPieces& text, std::uint64_t number, const AtomLabel& label) const;
  void write_header_end(const MeshCounts& counts, const TextSink& sink) const;
  /// The header of the file of the triangles, if there is one; its length does not depend on the
  /// counts.
  void write_face_header(const MeshCounts& counts, const TextSink& sink) const;

  void append_vertex(TextBuffer& text, const Vertex& vertex) const;
  /// `patch` is that of the triangle, see patch_of; any number if it is not needed.
  void append_triangle(TextBuffer& text, const Triangle& triangle, std::uint8_t patch) const;

  /// For a format with columns: they, the record of triangle number `number`, and what stands
  /// behind the columns.
  VtpData columns(const MeshCounts& counts) const { return vtp_data(counts, vtp_fields()); }
  static void append_triangle_record(TextBuffer& text, const Triangle& triangle,
                                     std::uint64_t number);
  static std::string_view behind_columns() { return vtp_end; }

 private:
  VtpFields vtp_fields() const;
  void append_ply_end(TextPieces& text, const MeshCounts& counts) const;
  void append_record(TextBuffer& text, const Vertex& vertex) const;
  void append_ply_line(TextBuffer& text, const Vertex& vertex) const;
  Color color_of(const Vertex& vertex) const;
  AtomIndex closest_atom(const Vertex& vertex) const;
  AtomIndex number_of(AtomIndex atom) const {
    return source_.atom_numbers.empty() ? atom : source_.atom_numbers[atom];
  }

  MeshFormat format_;
  MeshColor color_;
  MeshSource source_;
};

/// Whether vertices have a chain and a residue, where these are known.
bool names_atoms(const MeshOptions& choice);

/// Typical size of a mesh in bytes.
struct MeshBytes {
  std::uint64_t vertex = 0, triangle = 0;
  /// Of a vertex and a triangle, in files without a name until the mesh is complete.
  std::uint64_t waiting_vertex = 0, waiting_triangle = 0;
  /// Of each line that names a chain or residue, and of each character of a name.
  std::uint64_t name_line = 0, name_character = 0;
};

MeshBytes typical_mesh_bytes(const MeshOptions& choice, bool has_labels);

}  // namespace eses::detail::mesh
