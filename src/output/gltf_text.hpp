#pragma once
/// Binary glTF 2.0 (GLB), with all numbers in little-endian order:
/// https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
///
/// A file has a header of constant length with the JSON chunk, then the records of all vertices,
/// then the triangles. Positions are in single precision, relative to a whole number of angstrom
/// near the centre of the grid, to which the node of the mesh is translated.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "eses/grid.hpp"
#include "eses/summary.hpp"
#include "eses/vec3.hpp"
#include "mesh/triangulate.hpp"
#include "output/mesh_format.hpp"

namespace eses::detail::mesh {

/// Bounding box of positions as they are stored: in single precision, relative to the centre.
struct VertexBox {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

  void include(Vec3 position);
};

/// Size of a vertex record: position, normal and, with colours, red, green, blue and 255.
constexpr std::size_t gltf_vertex_bytes(bool has_colors) {
  return 6 * sizeof(float) + (has_colors ? 4 : 0);
}

/// Size of a triangle: three vertex numbers.
inline constexpr std::size_t gltf_triangle_bytes = 3 * sizeof(std::uint32_t);

/// Returns the centre to which the positions of vertices on a grid are relative.
Vec3 gltf_center(const Grid& grid);

/// Returns the part of the file before the vertices. Its length is constant.
std::string gltf_header(const MeshCounts& counts, bool has_colors, Vec3 center,
                        const VertexBox& box);

/// Throws Error if the length of the file exceeds its field in the header.
void require_gltf_size(const MeshCounts& counts, bool has_colors);

/// Writes the record of a vertex without its colour. Returns the end.
char* put_gltf_vertex(char* out, Vec3 position, Vec3 normal, Vec3 center);

/// Writes the colour of a vertex, which glTF expects in linear intensities. Returns the end.
char* put_gltf_color(char* out, const Color& color);

char* put_gltf_triangle(char* out, const Triangle& triangle);

}  // namespace eses::detail::mesh
