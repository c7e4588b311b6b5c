/// Tests of the shape of meshes: closed, oriented, and with the right area and volume.

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "mesh/vertex.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

struct MeshRun {
  Mesh mesh;
  EsesFiles files;
  Summary summary;
};

MeshRun run_mesh(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  Outputs outputs;
  outputs.mesh = MeshOptions{directory.path() / "mesh.ply"};
  MeshRun result;
  result.summary = run(atoms, parameters, outputs, directory.path());
  result.mesh = read_mesh(directory.path() / "mesh.ply");
  result.files = read_eses_files(directory.path());
  return result;
}

std::vector<Atom> make_ring(std::size_t count, double ring_radius, double radius) {
  std::vector<Atom> atoms;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    atoms.push_back({{ring_radius * std::cos(angle), ring_radius * std::sin(angle), 0.1}, radius});
  }
  return atoms;
}

}  // namespace

TEST_CASE("mesh: vertices are the crossings, in their order", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(80, 4);
  const Parameters parameters;
  const auto [mesh, files, summary] = run_mesh(atoms, parameters);
  REQUIRE(summary.mesh);
  CHECK(summary.mesh->vertices == mesh.positions.size());
  CHECK(summary.mesh->triangles == mesh.triangles.size());
  REQUIRE(mesh.positions.size() == files.crossings.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Crossing& crossing = files.crossings[v];
    REQUIRE(norm(mesh.positions[v] - crossing.point) <= 1e-11 * norm(crossing.point));
    REQUIRE(norm(mesh.normals[v] - crossing.normal) <= 1e-7);
    REQUIRE(mesh.patches[v] == static_cast<int>(crossing.atoms.size()));
    REQUIRE(mesh.atoms[v] == crossing.atoms.front());
  }
  CHECK(mesh.chains.empty());
  CHECK(mesh.colors.empty());
}

TEST_CASE("mesh: area and volume of a sphere converge to second order", "[mesh]") {
  constexpr double r = 2.1, pi = std::numbers::pi;
  std::vector<double> area_errors, volume_errors;
  for (const double spacing : {0.4, 0.2, 0.1}) {
    const Mesh mesh =
        run_mesh({{{0.13, -0.21, 0.34}, r}}, {.grid = GridOptions{.spacing = spacing}}).mesh;
    check_no_faults(mesh);
    const MeshMeasures measures = measure(mesh);
    CHECK(measures.euler_number == 2);
    CHECK(measures.components == 1);
    area_errors.push_back(4 * pi * r * r - measures.area);
    volume_errors.push_back(4 * pi / 3 * r * r * r - measures.volume);
  }
  for (const auto& errors : {area_errors, volume_errors}) {
    CHECK(errors[0] > 0);  // the triangles are chords
    for (std::size_t i = 0; i + 1 < errors.size(); ++i) {
      const double ratio = errors[i] / errors[i + 1];
      CHECK(ratio > 3.5);
      CHECK(ratio < 4.5);
    }
  }
  CHECK(area_errors.back() < 4 * pi * r * r * 1e-3);
}

TEST_CASE("mesh: a ring, a ball with a cavity and separate balls have the right Euler number",
          "[mesh]") {
  const auto shape_of = [](const std::vector<Atom>& atoms) {
    const Mesh mesh = run_mesh(atoms, {}).mesh;
    check_no_faults(mesh);
    return measure(mesh);
  };
  const MeshMeasures ring = shape_of(make_ring(12, 6, 1.8));
  CHECK(ring.euler_number == 0);
  CHECK(ring.components == 1);

  const MeshMeasures hollow = shape_of(make_icosahedron(5, 2.5));
  CHECK(hollow.euler_number == 4);
  CHECK(hollow.components == 2);

  const MeshMeasures apart = shape_of({{{0, 0, 0}, 1.5}, {{9, 0.1, 0}, 1.7}, {{0, 9, 0.2}, 1.2}});
  CHECK(apart.euler_number == 6);
  CHECK(apart.components == 3);
  constexpr double volumes = 1.5 * 1.5 * 1.5 + 1.7 * 1.7 * 1.7 + 1.2 * 1.2 * 1.2;
  CHECK(apart.volume == Approx(4 * std::numbers::pi / 3 * volumes).epsilon(0.05));
}

TEST_CASE("mesh: area and volume approximate those of the surface", "[mesh]") {
  const auto [mesh, files, summary] =
      run_mesh(make_chain(60, 9), {.grid = GridOptions{.spacing = 0.15}});
  const MeshMeasures measures = measure(mesh);
  CHECK(measures.area == Approx(summary.area).epsilon(0.01));
  CHECK(measures.volume == Approx(summary.volume).epsilon(0.01));
}

TEST_CASE("mesh: sets of every kind have a valid mesh, also with crossings on grid points",
          "[mesh]") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      INFO(kind_name(kind) << ", seed " << seed);
      Parameters parameters;
      parameters.probe_radius = designed_probe_radius(seed);
      grid_options(parameters).spacing = 0.5;
      grid_options(parameters).margin = 1;
      parameters.block_size = seed % 2 == 0 ? 5 : 64;
      const auto [mesh, files, summary] = run_mesh(make_atom_set(kind, seed), parameters);
      check_no_faults(mesh);
      if (mesh.triangles.empty()) continue;
      const double least = mesh::coincidence * grid_options(parameters).spacing;
      CHECK(measure(mesh).min_area > 0.5 * least * least);
      REQUIRE(mesh.positions.size() == files.crossings.size());
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        REQUIRE(norm(mesh.positions[v] - files.crossings[v].point) <
                1.01 * mesh::clearance * grid_options(parameters).spacing);
    }
}

TEST_CASE("mesh: a sphere through grid points has a valid mesh", "[mesh]") {
  // The centre, the poles and other points of the sphere (3-4-5) are grid points.
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1;
  const auto [mesh, files, summary] = run_mesh({{{0, 0, 0}, 2.5}}, parameters);
  std::size_t coincident = 0;
  for (const Crossing& crossing : files.crossings)
    for (const GridIndex& end : {crossing.inside, crossing.outside}) {
      Vec3 point = files.lower;
      for (std::size_t axis = 0; axis < 3; ++axis)
        point[axis] += static_cast<double>(end[axis]) * grid_options(parameters).spacing;
      coincident += norm(point - crossing.point) < 1e-9;
    }
  CHECK(coincident >= 30);
  check_no_faults(mesh);
  const MeshMeasures measures = measure(mesh);
  CHECK(measures.euler_number == 2);
  CHECK(measures.min_area > 1e-10);
}

TEST_CASE("mesh: an atom of radius 0 on a grid point has a valid mesh", "[mesh]") {
  Parameters parameters;
  grid_options(parameters).spacing = 0.5;
  grid_options(parameters).margin = 1;
  const Mesh mesh = run_mesh({{{0, 0, 0}, 0}}, parameters).mesh;
  check_no_faults(mesh);
  REQUIRE(mesh.triangles.size() == 8);
  CHECK(measure(mesh).min_area > 0);
}

TEST_CASE("mesh: the mesh is open only where the grid cuts the molecule", "[mesh]") {
  Parameters parameters;
  grid_options(parameters).margin = 0.2;
  const auto [mesh, files, summary] = run_mesh({{{0.1, 0.2, 0.3}, 2.15}}, parameters);
  std::set<std::pair<std::uint64_t, std::uint64_t>> sides;
  for (const MeshTriangle& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) sides.insert({t[i], t[(i + 1) % 3]});
  Vec3 upper = files.lower;
  for (std::size_t axis = 0; axis < 3; ++axis)
    upper[axis] += static_cast<double>(files.size[axis] - 1) * grid_options(parameters).spacing;
  std::size_t open = 0;
  for (const auto& [from, to] : sides) {
    if (sides.contains({to, from})) continue;
    ++open;
    const Vec3 a = mesh.positions[from], b = mesh.positions[to];
    bool is_on_face = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      is_on_face = is_on_face || (std::fabs(a[axis] - upper[axis]) < 1e-9 &&
                                  std::fabs(b[axis] - upper[axis]) < 1e-9);
    CHECK(is_on_face);
  }
  CHECK(open >= 12);  // three faces, each with a hole
}

TEST_CASE("mesh: a mesh is closed if the depth of the cut is negative", "[mesh]") {
  Random random(11);
  std::size_t open = 0;
  for (int i = 0; i < 40; ++i) {
    const double spacing = random.uniform(0.2, 0.4), radius = random.uniform(1, 2);
    const double range = std::array{0.0, 1.0, 300.0}[random.integer(0, 2)];
    const Vec3 center{random.uniform(-range, range), random.uniform(-range, range),
                      random.uniform(-range, range)};
    for (const double gap : {0.0, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9}) {
      INFO("set " << i << ", gap " << gap);
      // The last plane along x is the gap beyond the sphere, and has a point close to the x axis.
      const auto half = static_cast<std::int64_t>(radius / spacing) + 2;
      const GridIndex size{2 * half, 2 * half + 1, 2 * half + 1};
      const double across = static_cast<double>(half) * spacing;
      const Vec3 origin{center.x + radius + gap - static_cast<double>(size[0] - 1) * spacing,
                        center.y - across, center.z - across};
      Parameters parameters;
      parameters.grid = Grid{origin, spacing, size};
      const std::vector<Atom> atoms{{center, radius}};
      const double depth = make_plan(atoms, parameters, {}).cut_depth();
      const Mesh mesh = run_mesh(atoms, parameters).mesh;
      const bool is_closed = find_mesh_faults(mesh.positions.size(), mesh.triangles).empty();
      if (!is_closed) ++open;
      CHECK((is_closed || depth >= 0));
      CHECK((gap < 1e-9 || depth < 0));
    }
  }
  CHECK(open > 10);
}

}  // namespace eses::detail::test
