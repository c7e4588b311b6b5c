#include "api/mesh_in_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "grid/block_crossing.hpp"
#include "mesh/quality_mesh.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"

namespace eses::detail {
namespace {

detail::BlockCrossing as_in_blocks(const eses::Crossing& crossing) {
  detail::BlockCrossing result;
  result.coordinate = crossing.position[crossing.axis];
  result.normal = crossing.normal;
  result.atoms = crossing.atoms;
  result.axis = crossing.axis;
  result.atom_count = crossing.atom_count & 3;
  result.lower_is_inside = crossing.lower_is_inside ? 1 : 0;
  return result;
}

void add_vertex(const eses::Grid& grid, const eses::Crossing& crossing, double clearance,
                Mesh& mesh) {
  const mesh::Vertex vertex =
      mesh::make_vertex(grid, crossing.lower, as_in_blocks(crossing), clearance);
  mesh.vertices.push_back(vertex.position);
  mesh.normals.push_back(vertex.normal);
  mesh.atoms.push_back(vertex.first_atom());
  mesh.patches.push_back(vertex.patch);
}

// The indices of the rows of a mesh, and the number of vertices before each.
struct RowBegin {
  std::int64_t y, z;
  std::uint64_t first_vertex;
};

Mesh improve(const Mesh& plain, std::span<const RowBegin> rows, const eses::Grid& grid,
             const GridRegion& region, const CheckCallback& check) {
  Mesh mesh;
  mesh::QualityMesh quality_mesh(
      grid, region,
      {.vertex =
           [&](std::uint64_t vertex) {
             mesh.vertices.push_back(plain.vertices[vertex]);
             mesh.normals.push_back(plain.normals[vertex]);
             mesh.atoms.push_back(plain.atoms[vertex]);
             mesh.patches.push_back(plain.patches[vertex]);
             mesh.crossings.push_back(plain.crossings[vertex]);
             if (!plain.components.empty()) mesh.components.push_back(plain.components[vertex]);
           },
       .triangles =
           [&](std::span<const mesh::Triangle> triangles) {
             for (const auto& [a, b, c] : triangles)
               mesh.faces.push_back({quality_mesh.new_number(a), quality_mesh.new_number(b),
                                     quality_mesh.new_number(c)});
           }});
  std::uint64_t next = 0;
  auto row = rows.begin();
  for (const mesh::Triangle& triangle : plain.faces) {
    for (; next <= *std::max_element(triangle.begin(), triangle.end()); ++next) {
      for (; row + 1 != rows.end() && (row + 1)->first_vertex <= next; ++row)
        if (check) check();
      quality_mesh.add_vertex({.position = plain.vertices[next],
                               .normal = plain.normals[next],
                               .y = static_cast<std::int32_t>(row->y),
                               .z = static_cast<std::int32_t>(row->z),
                               .patch = plain.patches[next]});
    }
    quality_mesh.add_triangle(triangle);
  }
  quality_mesh.finish();
  return mesh;
}

}  // namespace

Mesh make_mesh(const eses::Grid& grid, const GridRegion& region,
               std::span<const std::uint8_t> inside, std::span<const eses::Crossing> crossings,
               const CheckCallback& check, bool quality, const ComponentOfVertex& component_of) {
  Mesh mesh;
  const double clearance = quality ? mesh::coincidence : mesh::clearance;
  const auto points = static_cast<std::size_t>(region.size()[0]);
  std::size_t next = 0;  // index of the next crossing
  // Makes the next row in canonical order, which has these indices in the grid, and its vertices.
  const auto make_row = [&](std::int64_t y, std::int64_t z, mesh::Row& row) {
    row.inside.assign(points / 64 + 1, 0);
    for (std::size_t x = 0; x < points; ++x)
      row.inside[x / 64] |= std::uint64_t{inside[x]} << (x % 64);
    inside = inside.subspan(points);
    row.edges.clear();
    row.first_vertex = mesh.vertices.size();
    for (; next < crossings.size(); ++next) {
      const eses::Crossing& crossing = crossings[next];
      if (crossing.lower[1] != y || crossing.lower[2] != z) break;
      if (!region.contains(crossing.upper())) continue;
      row.edges.push_back(mesh::edge_key(
          static_cast<std::uint64_t>(crossing.lower[0] - region.begin[0]), crossing.axis));
      add_vertex(grid, crossing, clearance, mesh);
      mesh.crossings.push_back(next);
      if (component_of) mesh.components.push_back(component_of(crossing));
    }
  };
  std::vector<RowBegin> row_begins;
  const auto rows_of_plane = static_cast<std::size_t>(region.size()[1]);
  std::vector<mesh::Row> below(rows_of_plane), plane(rows_of_plane);
  mesh::EdgeVertices edge_vertices;
  for (std::int64_t z = region.begin[2]; z < region.end[2]; ++z) {
    if (check) check();
    for (std::size_t y = 0; y < rows_of_plane; ++y) {
      if (quality) row_begins.push_back({static_cast<std::int64_t>(y), z, mesh.vertices.size()});
      make_row(region.begin[1] + static_cast<std::int64_t>(y), z, plane[y]);
    }
    for (std::size_t y = 1; z > region.begin[2] && y < rows_of_plane; ++y)
      mesh::triangulate({&below[y - 1], &below[y], &plane[y - 1], &plane[y]}, region.size()[0],
                        edge_vertices, mesh.faces);
    std::swap(below, plane);
  }
  return quality ? improve(mesh, row_begins, grid, region, check) : mesh;
}

}  // namespace eses::detail
