#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>

#include "cli/msms.hpp"
#include "eses/compute.hpp"
#include "eses/error.hpp"
#include "eses/surface.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_formatter.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail::cli {
namespace {

MsmsVertex vertex_of(const Mesh& mesh, std::size_t index, const eses::Crossing& crossing) {
  return {.position = mesh.vertices[index],
          .normal = mesh.normals[index],
          .patch = mesh.patches[index],
          .atoms = crossing.atoms};
}

/// Area of the triangles of an atom in a component, by patch: convex, saddle, concave.
using PatchWeights = std::array<double, 3>;
using Weights = std::map<std::pair<AtomIndex, std::uint32_t>, PatchWeights>;

/// Divides the triangles among the atoms. A vertex has a third of the area of each of its
/// triangles, and belongs to the same atom as in measure().
Weights find_weights(const MsmsSurface& surface, std::span<const Vec3> positions,
                     std::span<const Atom> spheres) {
  std::vector<double> area_of_vertex(positions.size());
  for (const mesh::Triangle& triangle : surface.triangles)
    for (const std::uint64_t corner : triangle)
      area_of_vertex[corner] += mesh::area_of(positions, triangle) / 3;
  Weights weights;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const MsmsVertex& vertex = surface.vertices[i];
    const AtomIndex atom = mesh::least_atom(vertex.adjacent_atoms(), [&](AtomIndex candidate) {
      const Atom& sphere = spheres[candidate];
      return squared_norm(vertex.position - sphere.center) - sphere.radius * sphere.radius;
    });
    weights[{atom, surface.components.of_vertex[i]}][vertex.patch - 1U] += area_of_vertex[i];
  }
  return weights;
}

/// Fractions of the patches of an atom that belong to a component. Patches that the triangles do
/// not resolve are divided like the whole area of the atom.
PatchWeights fractions_of(const PatchWeights& part, const PatchWeights& sum) {
  const double whole = sum[0] + sum[1] + sum[2], share = part[0] + part[1] + part[2];
  PatchWeights fractions;
  for (std::size_t patch = 0; patch < fractions.size(); ++patch)
    fractions[patch] = sum[patch] > 0 ? part[patch] / sum[patch] : whole > 0 ? share / whole : 1;
  return fractions;
}

/// Divides the analytical areas of the atoms among the components.
void divide_areas(const AtomAreas& areas, std::span<const Atom> spheres,
                  std::span<const Vec3> positions, MsmsSurface& surface) {
  Weights weights = find_weights(surface, positions, spheres);
  // Atoms without vertices have small areas only. They belong to the first component.
  for (AtomIndex atom = 0; atom < spheres.size(); ++atom) {
    const auto first = weights.lower_bound({atom, 0});
    if (first == weights.end() || first->first.first != atom) weights[{atom, 0}] = {};
  }
  std::vector<PatchWeights> sums(spheres.size());
  for (const auto& [key, part] : weights)
    for (std::size_t patch = 0; patch < part.size(); ++patch) sums[key.first][patch] += part[patch];
  surface.areas.resize(surface.components.all.size());
  for (const auto& [key, part] : weights) {
    const auto [atom, component] = key;
    const PatchWeights fractions = fractions_of(part, sums[atom]);
    const MsmsAreas divided{{fractions[0] * areas.convex[atom], fractions[1] * areas.saddle[atom],
                             fractions[2] * areas.concave[atom]},
                            fractions[0] * areas.sas[atom]};
    surface.atom_areas[key] = divided;
    MsmsAreas& sum = surface.areas[component];
    sum.ses.convex += divided.ses.convex;
    sum.ses.saddle += divided.ses.saddle;
    sum.ses.concave += divided.ses.concave;
    sum.sas += divided.sas;
  }
}

/// A mesh and the points and crossings from which it was made.
struct ComputedMesh {
  Result computed;
  Mesh mesh;
};

/// Makes the mesh on a grid whose spacing follows from the density. If no triangles result, as the
/// spheres lie between the points of the grid, makes it on finer grids.
ComputedMesh make_mesh(const Surface& surface, const MsmsOptions& options,
                       const CheckCallback& check) try {
  constexpr std::int64_t max_points = 1 << 24;  // of a finer grid
  double spacing = msms_grid(options).spacing;
  RunOptions running;
  if (check) running.progress = [&](std::int64_t, std::int64_t) { check(); };
  for (;; spacing /= 2) {
    const Grid grid = make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});
    Result computed =
        compute(surface, grid, ResultParts{.inside = true, .crossings = true}, running);
    Mesh mesh = make_quality_mesh(computed, check);
    const Grid finer = make_grid(surface, {.spacing = spacing / 2, .margin = spacing});
    if (!mesh.vertices.empty() || finer.point_count() > max_points)
      return {std::move(computed), std::move(mesh)};
  }
} catch (const GridTooLarge& error) {
  throw GridTooLarge(error.need(), "use a lower -density");
} catch (const HintedArgument& error) {  // whose hints are options of other commands
  throw std::invalid_argument(formatted("{} (-density)", error.what()));
}

}  // namespace

std::uint32_t MsmsSurface::component_at(std::span<const AtomIndex> atoms) const {
  std::vector<std::vector<std::uint64_t>> counts(components.all.size(),
                                                 std::vector<std::uint64_t>(atoms.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (const AtomIndex adjacent : vertices[i].adjacent_atoms())
      for (std::size_t k = 0; k < atoms.size(); ++k)
        if (atoms[k] == adjacent) ++counts[components.of_vertex[i]][k];
  // Cavity walls come before outer surfaces, then the components with more vertices.
  std::pair<bool, std::uint64_t> best{false, 0};
  std::uint32_t found = 0;
  for (std::uint32_t component = 0; component < counts.size(); ++component) {
    const std::vector<std::uint64_t>& of_atoms = counts[component];
    if (std::find(of_atoms.begin(), of_atoms.end(), 0U) != of_atoms.end()) continue;
    const auto sum = std::accumulate(of_atoms.begin(), of_atoms.end(), std::uint64_t{0});
    const std::pair<bool, std::uint64_t> rank{components.all[component].volume < 0, sum};
    if (rank <= best) continue;
    best = rank;
    found = component;
  }
  if (best.second == 0) throw Error("no component of the surface touches the atoms of -one_cavity");
  return found;
}

GridOptions msms_grid(const MsmsOptions& options) {
  const double spacing = std::sqrt(mesh::quality_vertices_per_area / options.density);
  // The grid may lack up to one spacing of its upper margin.
  return {.spacing = spacing, .margin = 2 * spacing};
}

MsmsSurface make_msms_surface(std::vector<Atom> spheres, const MsmsOptions& options,
                              const CheckCallback& check) {
  MsmsSurface result;
  const Surface surface(std::move(spheres), {.probe_radius = options.probe_radius, .check = check});
  const auto [computed, mesh] = make_mesh(surface, options, check);
  if (mesh.vertices.empty() && options.has_triangles)
    throw Error(
        formatted("no triangles at -density {}, as the spheres are too small; use a higher "
                  "density, or -surface ases",
                  options.density));
  result.triangles = mesh.faces;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const MsmsVertex& vertex =
        result.vertices.emplace_back(vertex_of(mesh, i, computed.crossings()[mesh.crossings[i]]));
    result.closest_atoms.push_back(
        mesh::closest_atom(vertex.position, vertex.adjacent_atoms(), surface.atoms()));
  }
  result.components = mesh::find_shells(mesh.vertices, mesh.faces);
  if (result.components.all.empty()) result.components.all.emplace_back();
  if (!options.has_areas) return result;
  const Measures measures = measure(surface, {.by_atom = true, .check = check});
  divide_areas(measures.by_atom, surface.atoms(), mesh.vertices, result);
  return result;
}

}  // namespace eses::detail::cli
