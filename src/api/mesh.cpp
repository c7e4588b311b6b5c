#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "api/arguments.hpp"
#include "eses/compute.hpp"
#include "geometry/block_crossing.hpp"
#include "mesh/quality_filter.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "surface/find_cavities.hpp"
#include "system/parallel.hpp"

namespace eses {
namespace {

namespace mesh = detail::mesh;

// Returns the component of a crossing. See Mesh::components.
using ComponentOfVertex = std::function<std::uint32_t(const Crossing& crossing)>;

detail::BlockCrossing as_in_blocks(const Crossing& crossing) {
  detail::BlockCrossing result;
  result.coordinate = crossing.position[crossing.axis];
  result.normal = crossing.normal;
  result.atoms = crossing.atoms;
  result.axis = crossing.axis;
  result.atom_count = crossing.atom_count & 3;
  result.lower_is_inside = crossing.lower_is_inside ? 1 : 0;
  return result;
}

// Appends a piece whose vertices are labelled with the indices of their crossings.
void append(Mesh& mesh, const mesh::MeshPiece& piece, std::span<const Crossing> crossings,
            const ComponentOfVertex& component_of) {
  for (const auto& [position, normal, labels] : piece.vertices) {
    const Crossing& crossing = crossings[labels.source];
    mesh.vertices.push_back(position);
    mesh.normals.push_back(normal);
    mesh.atoms.push_back(crossing.atoms[0]);
    mesh.patches.push_back(labels.patch);
    mesh.crossings.push_back(labels.source);
    if (component_of) mesh.components.push_back(component_of(crossing));
  }
  mesh.faces.insert(mesh.faces.end(), piece.triangles.begin(), piece.triangles.end());
}

// Returns the mesh of the cells that have all their corners in the region of a result. `check` is
// called for every plane, if it is not empty. The mesh has components unless `component_of` is
// empty.
Mesh mesh_in_memory(const Result& result, const CheckCallback& check, bool quality,
                    const ComponentOfVertex& component_of) {
  const Grid& grid = result.grid();
  const GridRegion& region = result.region();
  std::span<const std::uint8_t> inside = result.inside();  // of the points that are left
  const std::span<const Crossing> crossings = result.crossings();
  Mesh mesh;
  const auto append_piece = [&](const mesh::MeshPiece& piece) {
    append(mesh, piece, crossings, component_of);
  };
  std::optional<mesh::QualityFilter> filter;
  if (quality) filter.emplace(grid, region, mesh::PieceContents(), append_piece);
  mesh::MeshPiece piece;  // a plane
  const double clearance = quality ? mesh::coincidence : mesh::clearance;
  const auto points = static_cast<std::size_t>(region.size()[0]);
  std::size_t next = 0;            // index of the next crossing
  std::uint64_t vertex_count = 0;  // number of vertices before the next one
  // Makes the next row in canonical order, which has these indices in the grid, and its vertices.
  const auto make_row = [&](std::int64_t y, std::int64_t z, mesh::Row& row) {
    row.inside.assign(points / 64 + 1, 0);
    for (std::size_t x = 0; x < points; ++x)
      row.inside[x / 64] |= std::uint64_t{inside[x]} << (x % 64);
    inside = inside.subspan(points);
    row.edges.clear();
    row.first_vertex = vertex_count;
    for (; next < crossings.size(); ++next) {
      const Crossing& crossing = crossings[next];
      if (crossing.lower[1] != y || crossing.lower[2] != z) break;
      if (!region.contains(crossing.upper())) continue;
      row.edges.push_back(mesh::edge_key(
          static_cast<std::uint64_t>(crossing.lower[0] - region.begin[0]), crossing.axis));
      piece.vertices.push_back(
          mesh::make_vertex(grid, crossing.lower, as_in_blocks(crossing), clearance));
      piece.vertices.back().labels.source = static_cast<std::uint32_t>(next);
      ++vertex_count;
    }
  };
  const auto rows_of_plane = static_cast<std::size_t>(region.size()[1]);
  std::vector<mesh::Row> below(rows_of_plane), plane(rows_of_plane);
  mesh::EdgeVertices edge_vertices;
  for (std::int64_t z = region.begin[2]; z < region.end[2]; ++z) {
    if (check) check();
    piece.clear();
    for (std::size_t y = 0; y < rows_of_plane; ++y)
      make_row(region.begin[1] + static_cast<std::int64_t>(y), z, plane[y]);
    for (std::size_t y = 1; z > region.begin[2] && y < rows_of_plane; ++y)
      mesh::triangulate({&below[y - 1], &below[y], &plane[y - 1], &plane[y]}, region.size()[0],
                        edge_vertices, piece.triangles);
    if (filter)
      filter->add(piece);
    else
      append_piece(piece);
    std::swap(below, plane);
  }
  if (filter) filter->finish();
  return mesh;
}

// Returns a function for the components of the crossings of a surface.
ComponentOfVertex components_of(const Surface& surface, const CheckCallback& check) {
  const detail::Molecule& molecule = detail::SurfaceAccess::molecule(surface);
  const auto cavities = detail::find_cavities(molecule,
                                              {.probe_radius = surface.probe_radius(),
                                               .threads = detail::available_threads(),
                                               .check = check,
                                               .max_filled_void = surface.max_filled_void()},
                                              false)
                            .map;
  return [=, atoms = molecule.atoms(), probe = surface.probe_radius()](const Crossing& crossing) {
    return as_number(cavities->number_at(atoms, crossing.adjacent_atoms(),
                                         crossing.position + probe * crossing.normal));
  };
}

Mesh mesh_of(const Result& result, const CheckCallback& check, bool quality,
             const Surface* surface = nullptr) {
  if (!result.parts().inside || !result.parts().crossings)
    throw std::invalid_argument(
        "a mesh needs ResultParts::inside and ResultParts::crossings, which were not both chosen");
  detail::require_values(result.inside());
  return mesh_in_memory(result, check, quality,
                        surface != nullptr ? components_of(*surface, check) : ComponentOfVertex());
}

}  // namespace

Mesh make_mesh(const Result& result, const CheckCallback& check) {
  return mesh_of(result, check, false);
}

Mesh make_quality_mesh(const Result& result, const CheckCallback& check) {
  return mesh_of(result, check, true);
}

Mesh make_mesh(const Result& result, const Surface& surface, const CheckCallback& check) {
  return mesh_of(result, check, false, &surface);
}

Mesh make_quality_mesh(const Result& result, const Surface& surface, const CheckCallback& check) {
  return mesh_of(result, check, true, &surface);
}

}  // namespace eses
