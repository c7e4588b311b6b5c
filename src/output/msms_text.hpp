#pragma once
/// Text of the files NAME.vert and NAME.face of MSMS.
///
/// The columns are those of the manual page of MSMS (https://ccsb.scripps.edu/msms/). This program
/// does not number the patches, so that the columns of patch numbers contain 0.

#include <cstdint>

#include "eses/atoms.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "output/buffered_text.hpp"

namespace eses::detail::mesh {

/// Parameters of the surface in the headers.
struct MsmsSurface {
  std::uint64_t atom_count = 0;
  double probe_radius = 0, spacing = 0;  ///< angstrom
};

/// Append the three header lines of NAME.vert and NAME.face. Their length does not depend on the
/// count.
void append_msms_vertex_header(BufferedText& text, std::uint64_t vertices,
                               const MsmsSurface& surface);
void append_msms_face_header(BufferedText& text, std::uint64_t triangles,
                             const MsmsSurface& surface);

/// Upper bounds of the lengths of lines in the two files.
inline constexpr std::size_t max_msms_vertex_bytes = 168;
inline constexpr std::size_t max_msms_triangle_bytes = 48;

/// Writes a line of NAME.vert. `closest_atom` is the 0-based index of the closest atom that the
/// probe touches. Returns the end of the line.
char* put_msms_vertex(char* out, const Vertex& vertex, AtomIndex closest_atom);

/// Writes a line of NAME.face. `patch` is the result of patch_of. Returns the end of the line.
char* put_msms_triangle(char* out, const Triangle& triangle, std::uint8_t patch);

}  // namespace eses::detail::mesh
