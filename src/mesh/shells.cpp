#include "mesh/shells.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace eses::detail::mesh {
namespace {

/// Disjoint sets of vertices. The first vertex of a set represents it.
class VertexSets {
 public:
  explicit VertexSets(std::size_t vertices) : parent_(vertices) {
    std::iota(parent_.begin(), parent_.end(), std::uint64_t{0});
  }

  std::uint64_t find(std::uint64_t vertex) {
    while (parent_[vertex] != vertex) {
      parent_[vertex] = parent_[parent_[vertex]];
      vertex = parent_[vertex];
    }
    return vertex;
  }

  void join(std::uint64_t one, std::uint64_t other) {
    one = find(one);
    other = find(other);
    parent_[std::max(one, other)] = std::min(one, other);
  }

 private:
  std::vector<std::uint64_t> parent_;
};

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
  VertexSets sets(vertices.size());
  for (const Triangle& triangle : triangles) {
    sets.join(triangle[0], triangle[1]);
    sets.join(triangle[0], triangle[2]);
  }
  // Shells in the order of their first vertices, which are the origins for their volumes.
  std::vector<Shell> found;
  std::vector<Vec3> origins;
  std::vector<std::uint32_t> shell_of(vertices.size());
  for (std::uint64_t vertex = 0; vertex < vertices.size(); ++vertex) {
    const std::uint64_t first = sets.find(vertex);
    if (first == vertex) {
      shell_of[vertex] = static_cast<std::uint32_t>(found.size());
      found.emplace_back();
      origins.push_back(vertices[vertex]);
    }
    shell_of[vertex] = shell_of[first];
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
