#pragma once
/// The files NAME.vert and NAME.face of MSMS.
///
/// The columns are those of the manual page of MSMS (https://ccsb.scripps.edu/msms/);
/// M. F. Sanner, A. J. Olson, J. C. Spehner, Biopolymers 38 (1996), 305-320. Patches have no
/// numbers here, so that the columns for these hold 0.

#include <cstdint>

#include "eses/atoms.hpp"
#include "io/text_pieces.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::detail::mesh {

/// What the headers tell of the surface.
struct MsmsSurface {
  std::uint64_t atom_count = 0;
  double probe_radius = 0, spacing = 0;  ///< angstrom
};

/// The three header lines of NAME.vert and NAME.face. Their length does not depend on the count.
void append_msms_vertex_header(TextPieces& text, std::uint64_t vertices,
                               const MsmsSurface& surface);
void append_msms_face_header(TextPieces& text, std::uint64_t triangles, const MsmsSurface& surface);

/// The longest lines of the two files, in bytes.
inline constexpr std::size_t longest_msms_vertex = 168;
inline constexpr std::size_t longest_msms_triangle = 48;

/// A line of NAME.vert. `closest_atom` is the index, from 0, of the closest sphere that the probe
/// touches. Returns the end.
char* put_msms_vertex(char* out, const Vertex& vertex, AtomIndex closest_atom);

/// A line of NAME.face; `patch` is that of the triangle. Returns the end.
char* put_msms_triangle(char* out, const Triangle& triangle, std::uint8_t patch);

}  // namespace eses::detail::mesh
