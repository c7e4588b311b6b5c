#include "mesh/shells.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "system/disjoint_sets.hpp"

namespace eses::detail::mesh {
namespace {

/// Six times the volume of the tetrahedron of a triangle and a point, with its sign.
double six_volumes(std::span<const Vec3> vertices, const Triangle& triangle, Vec3 point) {
  const Vec3 a = vertices[triangle[0]] - point;
  return dot(a, cross(vertices[triangle[1]] - point, vertices[triangle[2]] - point));
}

/// Whether a shell comes before another one.
bool is_before(const Shell& one, const Shell& other) {
  if ((one.volume > 0) != (other.volume > 0)) return one.volume > 0;
  return std::fabs(one.volume) > std::fabs(other.volume);
}

}  // namespace

double area_of(std::span<const Vec3> vertices, const Triangle& triangle) {
  const Vec3 a = vertices[triangle[0]];
  return 0.5 * norm(cross(vertices[triangle[1]] - a, vertices[triangle[2]] - a));
}

Shells find_shells(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  DisjointSets sets(static_cast<DisjointSets::Element>(vertices.size()));
  for (const Triangle& triangle : triangles)
    for (const std::uint64_t corner : {triangle[1], triangle[2]})
      sets.unite(static_cast<DisjointSets::Element>(triangle[0]),
                 static_cast<DisjointSets::Element>(corner));
  // Shells in the order of their first vertices, which are the origins for their volumes.
  std::vector<std::uint32_t> shell_of = sets.labels();
  std::vector<Shell> found;
  std::vector<Vec3> origins;
  for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
    if (shell_of[vertex] == found.size()) {
      found.emplace_back();
      origins.push_back(vertices[vertex]);
    }
    ++found[shell_of[vertex]].vertex_count;
  }
  for (const Triangle& triangle : triangles) {
    const std::uint32_t shell = shell_of[triangle[0]];
    ++found[shell].triangle_count;
    found[shell].area += area_of(vertices, triangle);
    found[shell].volume += six_volumes(vertices, triangle, origins[shell]) / 6;
  }
  std::vector<std::uint32_t> order(found.size()), rank(found.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t one, std::uint32_t other) {
    return is_before(found[one], found[other]);
  });
  Shells shells;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    shells.all.push_back(found[order[i]]);
  }
  for (std::uint32_t& shell : shell_of) shell = rank[shell];
  shells.of_vertex = std::move(shell_of);
  return shells;
}

}  // namespace eses::detail::mesh
