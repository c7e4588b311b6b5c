#pragma once
/// Connected components of a closed mesh.

#include <cstdint>
#include <span>
#include <vector>

#include "eses/vec3.hpp"
#include "mesh/triangulate.hpp"

namespace eses::detail::mesh {

/// A connected component of a closed mesh.
struct Shell {
  std::uint64_t vertex_count = 0, triangle_count = 0;
  double area = 0;    ///< square angstrom
  double volume = 0;  ///< enclosed volume, in cubic angstrom; negative for the wall of a cavity
};

struct Shells {
  /// Outer shells, then walls of cavities. Both are ordered from the largest volume to the smallest
  /// one, and equal ones by their first vertex.
  std::vector<Shell> all;
  std::vector<std::uint32_t> of_vertex;  ///< index of the shell of each vertex
};

/// Finds the connected components. Each vertex must belong to a triangle. At most 2^32 - 1
/// vertices.
Shells find_shells(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Returns the area of a triangle, in square angstrom.
double area_of(std::span<const Vec3> vertices, const Triangle& triangle);

}  // namespace eses::detail::mesh
