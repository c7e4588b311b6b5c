/// Tests that the meshes of parts of the grid make up the mesh of the whole surface.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

/// A vertex: position, normal, patch and atom.
using Corner = std::array<double, 8>;
/// A triangle that starts at its lowest corner, so that it is the same whatever the vertices'
/// numbers.
using Facet = std::array<Corner, 3>;

std::vector<Facet> facets_of(const Mesh& mesh) {
  const auto corner = [&](std::uint64_t v) {
    const Vec3 p = mesh.positions[v], n = mesh.normals[v];
    return Corner{
        p[0], p[1], p[2], n[0], n[1], n[2], double(mesh.patches[v]), double(mesh.atoms[v])};
  };
  std::vector<Facet> facets;
  for (const MeshTriangle& t : mesh.triangles) {
    Facet facet{corner(t[0]), corner(t[1]), corner(t[2])};
    std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
    facets.push_back(facet);
  }
  return facets;
}

bool has_stray_vertices(const Mesh& mesh) {
  std::vector<bool> is_used(mesh.positions.size());
  for (const MeshTriangle& t : mesh.triangles)
    for (const std::uint64_t v : t) is_used[v] = true;
  return std::find(is_used.begin(), is_used.end(), false) != is_used.end();
}

struct PartRun {
  Mesh mesh;
  Summary summary;
  std::vector<std::string> files;  // all files except the mesh
};

PartRun run_part(const std::vector<Atom>& atoms, const Parameters& parameters, bool with_mesh) {
  const TemporaryDirectory directory;
  Outputs outputs;
  outputs.inside_map = "inside.vti";
  if (with_mesh) outputs.mesh = MeshOptions{directory.path() / "mesh.ply"};
  PartRun result;
  result.summary = run(atoms, parameters, outputs, directory.path());
  for (const char* name : eses_file_names)
    result.files.push_back(read_bytes(directory.path() / name));
  result.files.push_back(read_bytes(directory.path() / "inside.vti"));
  if (with_mesh) result.mesh = read_mesh(directory.path() / "mesh.ply");
  return result;
}

void check_same_but_for_mesh(const PartRun& with, const PartRun& without) {
  for (std::size_t i = 0; i < with.files.size(); ++i) {
    const bool same = with.files[i] == without.files[i];
    CHECK(same);
  }
  CHECK(with.summary.atom_areas == without.summary.atom_areas);
  CHECK(with.summary.volume == without.summary.volume);
  CHECK(with.summary.inside_points == without.summary.inside_points);
  CHECK(with.summary.edges() == without.summary.edges());
  CHECK(with.summary.saddle_area == without.summary.saddle_area);
}

/// Returns regions between random planes of points, which make up the grid.
std::vector<GridRegion> random_cuts(const GridIndex& size, Random& random) {
  std::array<std::vector<std::int64_t>, 3> planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    planes[axis] = {0, size[axis]};
    for (std::size_t cut = random.integer(0, 2); cut > 0; --cut)
      planes[axis].push_back(
          static_cast<std::int64_t>(random.integer(1, static_cast<std::size_t>(size[axis] - 1))));
    // There are also parts of one plane of points, and the last plane alone.
    if (random.chance(0.3)) planes[axis].push_back(size[axis] / 2);
    if (random.chance(0.3)) planes[axis].push_back(size[axis] / 2 + 1);
    if (random.chance(0.2)) planes[axis].push_back(size[axis] - 1);
    std::sort(planes[axis].begin(), planes[axis].end());
    planes[axis].erase(std::unique(planes[axis].begin(), planes[axis].end()), planes[axis].end());
  }
  std::vector<GridRegion> regions;
  for (std::size_t z = 0; z + 1 < planes[2].size(); ++z)
    for (std::size_t y = 0; y + 1 < planes[1].size(); ++y)
      for (std::size_t x = 0; x + 1 < planes[0].size(); ++x)
        regions.push_back({{planes[0][x], planes[1][y], planes[2][z]},
                           {planes[0][x + 1], planes[1][y + 1], planes[2][z + 1]}});
  return regions;
}

Box box_of(const Grid& grid, const GridRegion& region) {
  return {grid.point(region.begin),
          grid.point({region.end[0] - 1, region.end[1] - 1, region.end[2] - 1})};
}

void check_same_facets(std::vector<Facet> parts, const Mesh& whole) {
  std::vector<Facet> expected = facets_of(whole);
  std::sort(parts.begin(), parts.end());
  std::sort(expected.begin(), expected.end());
  CHECK(parts.size() == expected.size());
  const bool same = parts == expected;
  CHECK(same);
}

}  // namespace

TEST_CASE("mesh: the meshes of regions make up the mesh of the grid", "[mesh][region]") {
  Random random(64);
  std::size_t triangles = 0;
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      Parameters parameters;
      parameters.probe_radius = designed_probe_radius(seed);
      grid_options(parameters).spacing = 0.5;
      // With the smallest margin the surface may touch the faces of the grid.
      grid_options(parameters).margin = seed == 2 ? 0.25 : 0.8;
      const RunPlan plan = make_plan(atoms, parameters, {});
      const PartRun whole = run_part(atoms, parameters, true);
      INFO(kind_name(kind) << ", seed " << seed);
      std::vector<Facet> parts;
      for (const GridRegion& region : random_cuts(plan.grid.size, random)) {
        parameters.part = box_of(plan.grid, region);
        parameters.block_size = static_cast<std::int64_t>(random.integer(2, 40));
        parameters.threads = static_cast<int>(random.integer(1, 3));
        const PartRun part = run_part(atoms, parameters, true);
        CHECK_FALSE(has_stray_vertices(part.mesh));
        check_same_but_for_mesh(part, run_part(atoms, parameters, false));
        const std::vector<Facet> facets = facets_of(part.mesh);
        parts.insert(parts.end(), facets.begin(), facets.end());
      }
      triangles += parts.size();
      check_same_facets(std::move(parts), whole.mesh);
    }
  CHECK(triangles > 10000);
}

TEST_CASE("mesh: the meshes of blocks make up the mesh of the grid", "[mesh][region]") {
  const std::vector<Atom> atoms = make_chain(120, 31);
  for (const std::int64_t block_size : {16, 64}) {
    Parameters parameters;
    parameters.block_size = block_size;
    const PartRun whole = run_part(atoms, parameters, true);
    const GridIndex blocks = make_plan(atoms, parameters, {}).schedule.tiling.blocks;
    REQUIRE(blocks[0] * blocks[1] * blocks[2] > 1);
    for (const std::int64_t step : {1, 2}) {
      INFO("blocks of " << block_size << ", " << step << " along an axis");
      std::vector<Facet> parts;
      for (std::int64_t z = 0; z < blocks[2]; z += step)
        for (std::int64_t y = 0; y < blocks[1]; y += step)
          for (std::int64_t x = 0; x < blocks[0]; x += step) {
            parameters.part =
                BlockRange{{x, y, z},
                           {std::min(x + step, blocks[0]), std::min(y + step, blocks[1]),
                            std::min(z + step, blocks[2])}};
            const Mesh mesh = run_part(atoms, parameters, true).mesh;
            CHECK_FALSE(has_stray_vertices(mesh));
            const std::vector<Facet> facets = facets_of(mesh);
            parts.insert(parts.end(), facets.begin(), facets.end());
          }
      check_same_facets(std::move(parts), whole.mesh);
    }
  }
}

TEST_CASE("mesh: the mesh of a part does not depend on threads and block size", "[mesh][region]") {
  const std::vector<Atom> atoms = make_chain(120, 32);
  Parameters parameters;
  const Grid grid = make_plan(atoms, parameters, {}).grid;
  parameters.part = Box{grid.origin + Vec3{3, 4, 2.5}, grid.upper() - Vec3{5, 3, 6}};
  const auto bytes = [&] {
    const TemporaryDirectory directory;
    Outputs outputs = Outputs::none();
    outputs.mesh = MeshOptions{directory.path() / "mesh.ply"};
    run(atoms, parameters, outputs, directory.path());
    return read_bytes(directory.path() / "mesh.ply");
  };
  const std::string expected = bytes();
  REQUIRE(expected.size() > 10000);
  for (const int threads : {1, 3})
    for (const std::int64_t block_size : {3, 9, 33, 1000}) {
      INFO(threads << " threads, block size " << block_size);
      parameters.threads = threads;
      parameters.block_size = block_size;
      const bool same = bytes() == expected;
      CHECK(same);
    }
}

}  // namespace eses::detail::test
