#pragma once
/// Text of VTK's XML files of polygons (VTP), with the data as raw bytes after the XML:
/// https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
///
/// The data are columns: the positions of all vertices, then all normals, and so on. The offset of
/// a column depends on the number of vertices, which is known only after all of them have been
/// computed. Only the first column is written directly to the file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/outputs.hpp"
#include "eses/summary.hpp"
#include "mesh/triangulate.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail::mesh {

/// The optional fields of the vertices.
struct OptionalFields {
  bool has_colors = false;
  bool has_groups = false;  ///< chain and residue
  bool has_potential = false;
  bool has_components = false;
};

/// Returns the optional fields of the vertices with these colours.
OptionalFields optional_fields(MeshColor color, bool has_groups);

/// Returns what the comment of a file says about optional fields, with a semicolon before it.
std::string_view comment_of(const OptionalFields& fields);

/// A type of numbers and its names in PLY and VTP files.
struct NumberType {
  const char *ply_name, *vtp_name;
  std::size_t bytes;
};

/// A field of the record of a vertex.
struct VertexField {
  const char* name;  ///< in VTP files
  NumberType type;
  std::vector<const char*> components;  ///< names of the numbers in PLY files

  std::size_t bytes() const { return components.size() * type.bytes; }
};

/// Returns the fields of a vertex record in binary PLY files, which is also the record for VTP.
std::vector<VertexField> vertex_fields(const OptionalFields& optional);

/// Appends the XML before the data. `surface` is its name. Only files with groups have the names of
/// all chains and residues. The length does not depend on the counts.
void append_vtp_header(BufferedText& text, std::string_view surface, const OptionalFields& fields,
                       std::span<const AtomLabel> chains, std::span<const AtomLabel> residues,
                       const MeshCounts& counts);
/// The XML after the data.
inline constexpr std::string_view vtp_end = "\n</AppendedData>\n</VTKFile>\n";

/// Size of the vertices of a triangle and of its end in the list of all corners, in bytes.
inline constexpr std::size_t vtp_triangle_bytes = 3 * sizeof(std::int32_t),
                             vtp_offset_bytes = sizeof(std::int64_t);

/// Writes the vertices of a triangle. Returns the end.
char* put_vtp_triangle(char* out, const Triangle& triangle);

/// Appends the ends of the triangles [begin, end) in the list of all corners.
void append_vtp_ends(TextBuffer& text, std::uint64_t begin, std::uint64_t end);

}  // namespace eses::detail::mesh
