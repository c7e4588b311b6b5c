#pragma once
/// Triangles of a part of a mesh, while the number of vertices before the part is not known.

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "mesh/triangulate.hpp"
#include "output/mesh_writer.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail::mesh {

/// A triangle whose vertices are numbered from the first vertex of its part.
struct LocalTriangle {
  /// Numbers of the vertices. Vertices of the previous part have negative numbers.
  std::array<std::int32_t, 3> corners{};
  std::int32_t patch = 0;  ///< result of patch_of if the format needs it, else 0

  friend bool operator==(const LocalTriangle&, const LocalTriangle&) = default;
};

/// Appends a triangle as a LocalTriangle. Its vertices are numbered from the first vertex of the
/// part; negative numbers are given modulo 2^64.
inline void append_local_triangle(TextBuffer& bytes, const Triangle& triangle, std::uint8_t patch) {
  LocalTriangle local{{}, patch};
  for (std::size_t corner = 0; corner < triangle.size(); ++corner)
    local.corners[corner] = static_cast<std::int32_t>(triangle[corner]);
  char* const out = bytes.reserve(sizeof local);
  std::memcpy(out, &local, sizeof local);
  bytes.advance_to(out + sizeof local);
}

/// Appends triangles without patches in the same way.
inline void append_local_triangles(TextBuffer& bytes, std::span<const Triangle> triangles) {
  bytes.reserve(triangles.size() * sizeof(LocalTriangle));
  for (const Triangle& triangle : triangles) append_local_triangle(bytes, triangle, 0);
}

/// Appends triangles in the format of their file or, if `as_local`, as LocalTriangle. Formats with
/// the positions of corners have no LocalTriangle. `patch_of(i)` and `corners_of(i)` return the
/// patch of triangle i and the positions of its corners. They are called for formats that need
/// them.
template <class PatchOf, class CornersOf>
void append_triangles(TextBuffer& text, const MeshText& format, bool as_local,
                      std::span<const Triangle> triangles, PatchOf patch_of, CornersOf corners_of) {
  if (format.has_corner_positions()) {
    for (std::size_t i = 0; i < triangles.size(); ++i)
      MeshText::append_corners(text, corners_of(i));
  } else if (format.has_triangle_patches()) {
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (as_local) {
        append_local_triangle(text, triangles[i], patch_of(i));
      } else {
        format.append_triangle(text, triangles[i], patch_of(i));
      }
  } else if (as_local) {
    append_local_triangles(text, triangles);
  } else {
    format.append_triangles(text, triangles);
  }
}

/// Returns the vertex numbers in the whole mesh. `first` is the number of the part's first vertex.
inline Triangle global_triangle(std::uint64_t first, const LocalTriangle& local) {
  Triangle triangle{};
  for (std::size_t corner = 0; corner < triangle.size(); ++corner)
    triangle[corner] = first + static_cast<std::uint64_t>(std::int64_t{local.corners[corner]});
  return triangle;
}

}  // namespace eses::detail::mesh
