#pragma once
/// Text and binary records of mesh files.
///
/// PLY: https://paulbourke.net/dataformats/ply/
/// OBJ: https://paulbourke.net/dataformats/obj/
/// OFF: http://www.geomview.org/docs/html/OFF.html
/// STL: https://paulbourke.net/dataformats/stl/
/// MSMS: https://ccsb.scripps.edu/msms/, its manual page. This program does not number the patches,
/// so that the columns of patch numbers contain 0.
/// VTP: vtp_text.hpp; glTF: gltf_text.hpp

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "eses/grid.hpp"
#include "input/atom_names.hpp"
#include "mesh/piece.hpp"
#include "output/gltf_text.hpp"
#include "output/mesh_format.hpp"
#include "output/text_buffer.hpp"
#include "output/vtp_text.hpp"

namespace eses::detail::mesh {

/// Throws Error if there are more vertices than readers of mesh files can index.
void require_vertex_count(std::uint64_t vertices);

/// The data of mesh files besides vertices and triangles.
struct MeshSource {
  std::string_view surface = {};  ///< name of the surface, such as `solvent excluded surface`
  bool has_groups = false;        ///< whether vertices have chain and residue
  std::span<const AtomLabel> chains, residues;  ///< by number, if `has_groups`
  std::uint64_t atom_count = 0;                 ///< of the whole molecule
  double probe_radius = 0;                      ///< angstrom
  double density = 0;                          ///< expected number of vertices in a square angstrom
  Grid grid;                                   ///< the vertices lie on its edges
  std::optional<double> potential_limit = {};  ///< see MeshPotential; empty without a potential
};

/// The lists of a piece that a format needs.
constexpr PieceContents contents_of(MeshFormat format) {
  return {.vertices = format != MeshFormat::stl,
          .triangle_patches = format == MeshFormat::msms,
          .corners = format == MeshFormat::stl};
}

/// Formats mesh files. A file has a header and then its sections: in most formats all
/// vertices, then all triangles. MSMS has a header and the triangles in another file. STL has
/// triangles only. In VTP each field of the vertices is a section.
class MeshFormatter {
 public:
  MeshFormatter(MeshFormat format, MeshColor color, MeshSource source);

  /// Whether each field of the vertices is a section, see vtp_text.hpp.
  bool has_columns() const { return format_ == MeshFormat::vtp; }
  /// Number of sections. Their lengths depend only on the pieces that are appended.
  std::size_t section_count() const;

  /// Includes vertices in the box that is in the header, if the format has one.
  void extend_box(std::span<const Vertex> vertices, VertexBox& box) const;
  /// Appends the header, with the names of all chains and residues in formats for which
  /// can_name_groups is true. Its length does not depend on `counts` and `box`.
  void append_header(BufferedText& text, const MeshCounts& counts, const VertexBox& box) const;
  /// Appends the header of the separate file of the triangles. Its length does not depend on
  /// `counts`.
  void append_face_header(BufferedText& text, const MeshCounts& counts) const;

  /// Appends a piece to the texts of all sections. The numbers of its triangles are those of the
  /// whole mesh.
  void append(const MeshPiece& piece, std::span<TextBuffer> sections) const;
  /// Throws Error if the file of a mesh would be too large for its format.
  void require_counts(const MeshCounts& counts) const;

 private:
  void append_ply_header(BufferedText& text, const MeshCounts& counts) const;
  void append_vertex(TextBuffer& text, const Vertex& vertex) const;
  void append_columns(std::span<const Vertex> vertices, std::span<TextBuffer> columns) const;
  void append_triangles(const MeshPiece& piece, TextBuffer& text) const;
  template <class PutPosition, class PutNormal, class PutInteger, class PutPotential>
  char* put_fields(char* out, const Vertex& vertex, PutPosition put_position, PutNormal put_normal,
                   PutInteger put_integer, PutPotential put_potential) const;
  char* put_coordinates(char* out, const Vertex& vertex) const;
  char* put_record(char* out, const Vertex& vertex) const;
  char* put_ply_line(char* out, const Vertex& vertex) const;
  char* put_obj_vertex(char* out, const Vertex& vertex) const;
  char* put_glb_vertex(char* out, const Vertex& vertex) const;
  Color color_of(const Vertex& vertex) const;

  MeshFormat format_;
  MeshColor color_;
  MeshSource source_;
  OptionalFields optional_;
  Vec3 gltf_center_;
  TokensOfAxes coordinates_;  // only for formats whose text has the digits of write_scientific()
  std::vector<VertexField> fields_;  // of a record
};

/// Whether the format has the names of chains and residues, if these are known.
bool can_name_groups(const MeshOptions& choice);

/// Typical sizes of the elements of a mesh, in bytes.
struct MeshBytes {
  std::uint64_t vertex = 0, triangle = 0;
  /// Sizes of a vertex and a triangle in scratch files: all sections but the first one of a file.
  std::uint64_t scratch_vertex = 0, scratch_triangle = 0;
  /// Sizes of a line with the name of a chain or residue, without the name, and of each character
  /// of the name.
  std::uint64_t name_line = 0, name_character = 0;
};

MeshBytes typical_mesh_bytes(const MeshOptions& choice, bool has_labels);

/// Expected number of vertices of a plain mesh in an area of the square of the spacing. An element
/// of the surface with unit normal n has (|n_x| + |n_y| + |n_z|) / spacing^2 crossings per area,
/// and the mean of the sum over all directions is 3/2.
inline constexpr double plain_vertices_per_area = 1.5;
/// Measured number of vertices of a mesh of quality in this area; see doc/msms.md.
inline constexpr double quality_vertices_per_area = 0.86;

/// Appends the three header lines of NAME.vert or NAME.face with this number of vertices or
/// triangles, on which their length does not depend. `density` is the expected number of vertices
/// in a square angstrom, and the probe radius is in angstrom.
void append_msms_header(BufferedText& text, std::string_view surface, bool has_faces,
                        std::uint64_t count, std::uint64_t atom_count, double density,
                        double probe_radius);

/// Upper bounds of the lengths of lines in the two files, without a name.
inline constexpr std::size_t max_msms_vertex_bytes = 168;
inline constexpr std::size_t max_msms_triangle_bytes = 48;

/// Writes a line of NAME.vert. `closest_atom` is the closest atom that the probe touches. `name` is
/// the name of this atom, which gives a tenth column; empty for none. Returns the end of the line.
char* put_msms_vertex(char* out, const Vec3& position, const Vec3& normal, std::uint8_t patch,
                      FileIndex closest_atom, std::string_view name = {});

/// Writes a line of NAME.face. `patch` is the result of patch_of. Returns the end of the line.
char* put_msms_triangle(char* out, const Triangle& triangle, std::uint8_t patch);

}  // namespace eses::detail::mesh
