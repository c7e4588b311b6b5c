/// Checks of the shape of meshes.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "catch.hpp"
#include "support/mesh_files.hpp"

namespace eses::detail::test {
namespace {

using DirectedEdge = std::pair<std::uint64_t, std::uint64_t>;

// For each triangle at a vertex, the edge opposite to it is on the rim of the fan.
using Rim = std::map<std::uint64_t, std::uint64_t>;

bool is_one_ring(const Rim& rim) {
  if (rim.empty()) return false;
  std::size_t steps = 0;
  std::uint64_t at = rim.begin()->first;
  do {
    const auto next = rim.find(at);
    if (next == rim.end()) return false;
    at = next->second;
    ++steps;
  } while (at != rim.begin()->first && steps <= rim.size());
  return steps == rim.size();
}

std::size_t count_components(const Mesh& mesh) {
  std::vector<std::size_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const MeshTriangle& t : mesh.triangles)
    for (const std::uint64_t v : t) parent[root(v)] = root(t[0]);
  std::size_t count = 0;
  for (std::size_t v = 0; v < parent.size(); ++v) count += parent[v] == v;
  return count;
}

}  // namespace

std::vector<std::string> find_mesh_faults(std::size_t vertices,
                                          std::span<const MeshTriangle> triangles) {
  std::vector<std::string> faults;
  std::map<DirectedEdge, int> edges;
  std::set<MeshTriangle> seen;
  std::vector<Rim> rims(vertices);
  for (const MeshTriangle& t : triangles) {
    MeshTriangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[2] >= vertices) return {"a triangle has a vertex that is not there"};
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2])
      faults.push_back(fmt::format("triangle {} {} {} has a vertex twice", t[0], t[1], t[2]));
    if (!seen.insert(sorted).second)
      faults.push_back(fmt::format("triangle {} {} {} is there twice", t[0], t[1], t[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{t[i], t[(i + 1) % 3]}];
      rims[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    if (count != 1 || opposite == edges.end())
      faults.push_back(fmt::format("edge {} {}: {} triangles, {} on its other side", edge.first,
                                   edge.second, count,
                                   opposite == edges.end() ? 0 : opposite->second));
  }
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_one_ring(rims[v])) faults.push_back(fmt::format("vertex {}: not one fan", v));
  return faults;
}

MeshMeasures measure(const Mesh& mesh) {
  MeshMeasures result;
  std::set<DirectedEdge> edges;
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const double area = 0.5 * norm(cross(b - a, c - a));
    if (result.area == 0 || area < result.min_area) result.min_area = area;
    result.area += area;
    const Vec3 origin = mesh.positions[0];  // keeps cancellation small
    result.volume += dot(a - origin, cross(b - origin, c - origin)) / 6;
    for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax({t[i], t[(i + 1) % 3]}));
  }
  result.euler_number =
      static_cast<std::int64_t>(mesh.positions.size() + mesh.triangles.size() - edges.size());
  result.components = count_components(mesh);
  return result;
}

void check_no_faults(const Mesh& mesh) {
  const std::vector<std::string> faults = find_mesh_faults(mesh.positions.size(), mesh.triangles);
  INFO(faults.size() << " faults, the first: " << (faults.empty() ? "" : faults.front()));
  CHECK(faults.empty());
}

}  // namespace eses::detail::test
