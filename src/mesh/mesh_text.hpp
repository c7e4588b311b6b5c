#pragma once
/// The bytes of mesh files.
///
/// PLY: G. Turk, https://paulbourke.net/dataformats/ply/
/// OBJ: https://paulbourke.net/dataformats/obj/
/// OFF: http://www.geomview.org/docs/html/OFF.html

#include <array>
#include <cstdint>
#include <string>

#include "eses/mesh.hpp"
#include "io/eses_text.hpp"
#include "mesh/atom_groups.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::mesh {

/// Throws Error if there are more vertices than readers of such files can number.
void require_numbers(std::uint64_t vertices);

/// A file is the header, all vertices, all triangles.
class MeshText {
 public:
  MeshText(MeshFormat format, MeshColor color, AtomGroups groups);

  /// Has the same length whatever the counts.
  std::string header(const MeshCounts& counts) const;
  void append_vertex(TextBuffer& text, const Vertex& vertex) const;
  void append_triangle(TextBuffer& text, const Triangle& triangle) const;

 private:
  std::string ply_header(const MeshCounts& counts) const;
  void append_ply_vertex(TextBuffer& text, const Vertex& vertex) const;
  std::array<std::uint8_t, 3> color_of(const Vertex& vertex) const;

  MeshFormat format_;
  MeshColor color_;
  AtomGroups groups_;
};

/// Bytes of a vertex and of a triangle, typically.
std::uint64_t typical_vertex_bytes(const MeshChoice& choice, bool has_labels);
std::uint64_t typical_triangle_bytes(const MeshChoice& choice);

}  // namespace eses::mesh
