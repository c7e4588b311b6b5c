#pragma once
/// Text and binary records of mesh files.
///
/// PLY: https://paulbourke.net/dataformats/ply/
/// OBJ: https://paulbourke.net/dataformats/obj/
/// OFF: http://www.geomview.org/docs/html/OFF.html
/// STL: https://paulbourke.net/dataformats/stl/
/// MSMS: msms_text.hpp; VTP: vtp_text.hpp; glTF: gltf_text.hpp

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "eses/grid.hpp"
#include "input/file_index.hpp"
#include "input/potential_map.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "output/buffered_text.hpp"
#include "output/gltf_text.hpp"
#include "output/mesh_format.hpp"
#include "output/mesh_groups.hpp"
#include "output/text_buffer.hpp"
#include "output/vertex_color.hpp"
#include "output/vtp_text.hpp"

namespace eses::detail::mesh {

/// Throws Error if there are more vertices than readers of mesh files can index.
void require_vertex_count(std::uint64_t vertices);

/// The potential of the vertices.
struct VertexPotential {
  const PotentialMap* map = nullptr;  ///< null without a potential
  double offset = 0;                  ///< see MeshPotential
  double limit = 0;                   ///< see MeshPotential
};

/// Atoms and parameters that mesh files contain besides vertices and triangles. All spans must
/// outlive the MeshText.
struct MeshSource {
  AtomGroups groups;
  FileIndices file_indices;
  std::span<const Atom> atoms;   ///< by slab index
  std::uint64_t atom_count = 0;  ///< number of atoms of the whole molecule
  double probe_radius = 0;       ///< angstrom
  double density = 0;            ///< expected number of vertices in a square angstrom
  Grid grid;                     ///< the vertices lie on its edges
  Vec3 center;                   ///< centre of the grid, in angstrom
  VertexPotential potential = {};
};

/// Makes the text of mesh files. Most formats have one file: a header, all vertices, all triangles.
/// MSMS has a header and the vertices in one file, a header and the triangles in another. For VTP,
/// vertices and triangles are first made as records, which are later divided into columns.
class MeshText {
 public:
  MeshText(MeshFormat format, MeshColor color, MeshSource source);

  /// Whether the triangles are in a separate file.
  bool has_face_file() const { return format_ == MeshFormat::msms; }
  /// Whether the records of vertices and triangles must be divided into columns, see vtp_text.hpp.
  bool has_columns() const { return format_ == MeshFormat::vtp; }
  /// Whether the triangles have the positions of their corners instead of numbers of vertices. Then
  /// `append_corners` writes them, and `append_vertex` writes nothing.
  bool has_corner_positions() const { return format_ == MeshFormat::stl; }
  /// Size of the records of vertices whose bounding box is in the header; 0 if there is none.
  std::size_t boxed_vertex_bytes() const {
    return format_ == MeshFormat::glb ? gltf_vertex_bytes(has_colors()) : 0;
  }
  /// Whether `append_triangle` needs the triangles' patches.
  bool has_triangle_patches() const { return format_ == MeshFormat::msms; }

  /// Append the parts of the header: its beginning, the names of all chains, its middle, the names
  /// of all residues, its end. Names are appended only in formats for which can_name_groups is
  /// true. The length of no part depends on `counts` and `box`.
  void append_header_begin(BufferedText& text) const;
  void append_chain_name(BufferedText& text, std::uint64_t number, const AtomLabel& label) const;
  void append_header_middle(BufferedText& text) const;
  void append_residue_name(BufferedText& text, std::uint64_t number, const AtomLabel& label) const;
  /// `box` is the bounding box of the vertices if `boxed_vertex_bytes` is not 0.
  void append_header_end(BufferedText& text, const MeshCounts& counts, const VertexBox& box) const;
  /// Appends the header of the separate file of the triangles. Its length does not depend on
  /// `counts`.
  void append_face_header(BufferedText& text, const MeshCounts& counts) const;

  /// Throws Error if the map of the potential does not contain the vertex.
  void append_vertex(TextBuffer& text, const Vertex& vertex) const;
  /// `patch` is the result of patch_of, or any number if has_triangle_patches() is false.
  void append_triangle(TextBuffer& text, const Triangle& triangle, std::uint8_t patch) const;
  /// Appends triangles, only if has_triangle_patches() is false.
  void append_triangles(TextBuffer& text, std::span<const Triangle> triangles) const;

  /// Appends a triangle by the positions of its corners, only if has_corner_positions() is true.
  static void append_corners(TextBuffer& text, const std::array<Vec3, 3>& corners);
  /// Throws Error if the file of a mesh would be too large for its format.
  void require_counts(const MeshCounts& counts) const;

  /// The optional fields of the vertices.
  OptionalFields optional_fields() const;

 private:
  bool has_colors() const { return color_ != MeshColor::none; }
  bool has_components() const { return color_ == MeshColor::component; }
  void append_ply_end(BufferedText& text, const MeshCounts& counts) const;
  template <class PutPosition, class PutNormal, class PutInteger, class PutPotential>
  char* put_fields(char* out, const Vertex& vertex, PutPosition put_position, PutNormal put_normal,
                   PutInteger put_integer, PutPotential put_potential) const;
  char* put_coordinates(char* out, const Vertex& vertex) const;
  char* put_record(char* out, const Vertex& vertex) const;
  char* put_ply_line(char* out, const Vertex& vertex) const;
  char* put_obj_vertex(char* out, const Vertex& vertex) const;
  char* put_glb_vertex(char* out, const Vertex& vertex) const;
  double potential_of(const Vertex& vertex) const;
  Color color_of(const Vertex& vertex, double potential) const;
  AtomIndex closest_atom(const Vertex& vertex) const;

  MeshFormat format_;
  MeshColor color_;
  MeshSource source_;
  TokensOfAxes coordinates_;  // only for formats whose text has the digits of write_scientific()
};

/// Whether the format has the names of chains and residues, if these are known.
bool can_name_groups(const MeshOptions& choice);

/// Typical sizes of the elements of a mesh, in bytes.
struct MeshBytes {
  std::uint64_t vertex = 0, triangle = 0;
  /// Sizes of a vertex and a triangle in temporary files.
  std::uint64_t scratch_vertex = 0, scratch_triangle = 0;
  /// Sizes of a line with the name of a chain or residue, without the name, and of each character
  /// of the name.
  std::uint64_t name_line = 0, name_character = 0;
};

MeshBytes typical_mesh_bytes(const MeshOptions& choice, bool has_labels);

}  // namespace eses::detail::mesh
