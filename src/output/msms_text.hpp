#pragma once
/// Text of the files NAME.vert and NAME.face of MSMS.
///
/// The columns follow the manual page of MSMS (https://ccsb.scripps.edu/msms/). This program
/// does not number the patches, so that the columns of patch numbers contain 0.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "input/file_index.hpp"
#include "mesh/triangulate.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail::mesh {

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
