/// Tests of the improvement of meshes: angles, topology, positions, and invariance.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/read_atoms.hpp"
#include "mesh/sliding_list.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/mesh_intersections.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

using Points = std::array<Vec3, 3>;

struct QualityRun {
  Mesh mesh;
  EsesFiles files;
  Summary summary;
  std::string bytes;
};

QualityRun run_mesh(const std::vector<Atom>& atoms, const Parameters& parameters, bool quality,
                    MeshOptions choice = {.file = "mesh.ply"}) {
  const TemporaryDirectory directory;
  choice.file = directory.path() / choice.file;
  choice.quality = quality;
  Outputs outputs;
  outputs.mesh = choice;
  QualityRun result;
  result.summary = run(atoms, parameters, outputs, directory.path());
  result.mesh = read_mesh(choice.file);
  result.files = read_eses_files(directory.path());
  result.bytes = read_bytes(choice.file);
  return result;
}

Points points_of(const Mesh& mesh, const MeshTriangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

// Returns the smallest angle in degrees.
double smallest_angle(const Points& t) {
  double smallest = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 u = t[(i + 1) % 3] - t[i], v = t[(i + 2) % 3] - t[i];
    smallest =
        std::min(smallest, std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi);
  }
  return smallest;
}

// Whether normals at two corners form an angle of more than 60 degrees.
bool is_at_cusp(const Mesh& mesh, const MeshTriangle& t) {
  const auto normal = [&](std::size_t i) { return mesh.normals[t[i]]; };
  return std::min({dot(normal(0), normal(1)), dot(normal(1), normal(2)),
                   dot(normal(2), normal(0))}) < 0.5;
}

void check_quality_mesh(const QualityRun& plain, const QualityRun& improved, double spacing) {
  const Mesh& mesh = improved.mesh;
  const std::vector<std::string> faults = find_mesh_faults(mesh.positions.size(), mesh.triangles);
  INFO(faults.size() << " faults, the first: " << (faults.empty() ? "" : faults.front()));
  CHECK(faults.empty());
  const MeshMeasures before = measure(plain.mesh), after = measure(mesh);
  CHECK(after.euler_number == before.euler_number);
  CHECK(after.components == before.components);
  CHECK(find_intersections(mesh.positions, mesh.triangles).empty());
  CHECK(mesh.triangles.size() == improved.summary.mesh->triangles);
  CHECK(mesh.positions.size() == improved.summary.mesh->vertices);

  const MeshQuality& quality = improved.summary.mesh_quality.value();
  std::vector<bool> is_near_cusp(mesh.positions.size());
  std::uint64_t at_cusps = 0;
  for (const MeshTriangle& t : mesh.triangles)
    if (is_at_cusp(mesh, t)) {
      ++at_cusps;
      for (const auto vertex : t) is_near_cusp[vertex] = true;
    }
  double smallest = 90;
  std::uint64_t below_20 = 0, below_5 = 0, below_5_near_cusps = 0;
  for (const MeshTriangle& t : mesh.triangles) {
    const double angle = smallest_angle(points_of(mesh, t));
    smallest = std::min(smallest, angle);
    if (angle < 20) ++below_20;
    if (angle >= 5) continue;
    ++below_5;
    if (is_near_cusp[t[0]] || is_near_cusp[t[1]] || is_near_cusp[t[2]]) ++below_5_near_cusps;
  }
  CHECK(std::fabs(quality.smallest_angle - smallest) < 1e-6);
  CHECK(quality.below_20 == below_20);
  CHECK(quality.below_5 == below_5);
  CHECK(quality.at_cusps == at_cusps);
  CHECK(quality.below_5_near_cusps == below_5_near_cusps);

  // The vertices are crossings in the same order, with their normals and atoms.
  std::size_t next = 0, missing = 0;
  const auto& crossings = improved.files.crossings;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto is_same = [&](const auto& crossing) {
      return norm(crossing.point - mesh.positions[v]) < 1.1e-6 * spacing &&
             norm(crossing.normal - mesh.normals[v]) < 1e-6 &&
             crossing.atoms.front() == std::int64_t{mesh.atoms[v]};
    };
    while (next < crossings.size() && !is_same(crossings[next])) ++next;
    if (next++ >= crossings.size()) ++missing;
  }
  CHECK(missing == 0);
}

std::vector<Atom> atoms_of(const char* file) {
  return read_atoms(std::string(ESES_DATA "/") + file).atoms;
}

}  // namespace

TEST_CASE("elements of a sliding list keep their indices", "[mesh]") {
  mesh::SlidingList<std::uint32_t> list;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    REQUIRE(list.end() == i);
    list.push_back(i);
    if (i % 700 == 699) {
      list.remove_before(i - 400);
      first = i - 400;
      CHECK(list.first() == first);
    }
    // An index modulo 2^12 is enough for up to 2^11 elements.
    REQUIRE(list[first] == first);
    REQUIRE(list[i & 0xFFFU] == i);
  }
}

TEST_CASE("quality mesh: angles and topology of molecules", "[mesh][quality]") {
  for (const char* const name : {"c60.xyzr", "fas2.pqr", "1ubq.xyzr", "boxb.pqr"}) {
    INFO(name);
    const std::vector<Atom> atoms = atoms_of(name);
    const Parameters parameters;
    const QualityRun plain = run_mesh(atoms, parameters, false);
    const QualityRun improved = run_mesh(atoms, parameters, true);
    check_quality_mesh(plain, improved, 0.4);
    const MeshQuality& quality = improved.summary.mesh_quality.value();
    CHECK(1000 * quality.below_20 < improved.mesh.triangles.size());
    CHECK(quality.below_5 == quality.below_5_near_cusps);
    CHECK_FALSE(plain.summary.mesh_quality);
  }
}

TEST_CASE("quality mesh: random and degenerate sets", "[mesh][quality]") {
  for (const Kind kind : all_kinds)
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      INFO(kind_name(kind) << ", seed " << seed);
      const std::vector<Atom> atoms = make_atom_set(kind, seed);
      Parameters parameters;
      parameters.probe_radius = designed_probe_radius(seed);
      grid_options(parameters).spacing = seed % 2 == 0 ? 0.5 : 0.8;
      check_quality_mesh(run_mesh(atoms, parameters, false), run_mesh(atoms, parameters, true),
                         grid_options(parameters).spacing);
    }
}

TEST_CASE("quality mesh: bytes do not depend on threads and block size", "[mesh][quality]") {
  const std::vector<Atom> atoms = make_chain(80, 12);
  for (const MeshOptions& choice :
       {MeshOptions{.file = "a.ply"}, MeshOptions{.file = "a.vtp"}, MeshOptions{.file = "a.vert"},
        MeshOptions{.file = "a.stl"}, MeshOptions{.file = "a.glb"}, MeshOptions{.file = "a.obj"},
        MeshOptions{.file = "a.off"}}) {
    Parameters parameters;
    const std::string expected = run_mesh(atoms, parameters, true, choice).bytes;
    REQUIRE(expected.size() > 10000);
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {2, 7, 1000}) {
        INFO(choice.file << ", " << threads << " threads, block size " << block_size);
        parameters.threads = threads;
        parameters.block_size = block_size;
        const bool same = run_mesh(atoms, parameters, true, choice).bytes == expected;
        CHECK(same);
      }
  }
}

TEST_CASE("quality mesh: all formats have the same triangles", "[mesh][quality]") {
  const std::vector<Atom> atoms = make_chain(60, 5);
  const Mesh ply = run_mesh(atoms, {}, true).mesh;
  for (const char* const name : {"a.obj", "a.off", "a.vtp", "a.vert", "a.glb"}) {
    INFO(name);
    const Mesh other = run_mesh(atoms, {}, true, {.file = name}).mesh;
    const bool same = other.triangles == ply.triangles;
    CHECK(same);
    CHECK(other.positions.size() == ply.positions.size());
  }
  const Mesh stl = run_mesh(atoms, {}, true, {.file = "a.stl"}).mesh;
  REQUIRE(stl.triangles.size() == ply.triangles.size());
  double farthest = 0;
  for (std::size_t t = 0; t < stl.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      farthest = std::max(
          farthest, norm(stl.positions[stl.triangles[t][i]] - ply.positions[ply.triangles[t][i]]));
  CHECK(farthest < 1e-5);
}

TEST_CASE("quality mesh: the header of MSMS has the density of the vertices", "[mesh][quality]") {
  const QualityRun improved = run_mesh(atoms_of("1ubq.xyzr"), {}, true, {.file = "mesh.vert"});
  const auto [vertices, spheres, density, probe_radius] = improved.mesh.msms_header;
  CHECK(vertices == static_cast<double>(improved.mesh.positions.size()));
  CHECK(vertices / improved.summary.area == Catch::Approx(density).epsilon(0.02));
}

TEST_CASE("quality mesh: parts of the grid meet at the same border", "[mesh][quality]") {
  const std::vector<Atom> atoms = make_chain(120, 31);
  Parameters parameters;
  parameters.block_size = 16;
  const GridIndex blocks = make_plan(atoms, parameters, {}).schedule.tiling.blocks;
  REQUIRE(blocks[2] > 1);
  // Each edge of a triangle occurs once in each direction in all parts together.
  std::map<std::array<double, 6>, int> edges;
  std::size_t triangles = 0;
  for (std::int64_t z = 0; z < blocks[2]; ++z) {
    parameters.part = BlockRange{{0, 0, z}, {blocks[0], blocks[1], z + 1}};
    const TemporaryDirectory directory;
    Outputs outputs = Outputs::none();
    outputs.mesh = MeshOptions{.file = directory.path() / "mesh.ply", .quality = true};
    run(atoms, parameters, outputs, directory.path());
    const Mesh mesh = read_mesh(outputs.mesh->file);
    triangles += mesh.triangles.size();
    for (const MeshTriangle& t : mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 a = mesh.positions[t[i]], b = mesh.positions[t[(i + 1) % 3]];
        ++edges[{a.x, a.y, a.z, b.x, b.y, b.z}];
      }
  }
  REQUIRE(triangles > 1000);
  std::size_t faults = 0;
  for (const auto& [edge, count] : edges) {
    const auto other = edges.find({edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]});
    if (count != 1 || other == edges.end()) ++faults;
  }
  CHECK(faults == 0);
}

}  // namespace eses::detail::test
