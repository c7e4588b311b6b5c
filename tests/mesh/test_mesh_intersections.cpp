/// Tests that triangles of plain and quality meshes do not intersect, in exact arithmetic.
///
/// The environment variable ESES_MESH_SETS=N sets the number of random atom sets.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "catch.hpp"
#include "eses/compute.hpp"
#include "eses/measure.hpp"
#include "eses/read_atoms.hpp"
#include "mesh/case_table.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/measured_sets.hpp"
#include "support/mesh_files.hpp"
#include "support/mesh_intersections.hpp"
#include "support/near_degenerate.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

// --- the table ----------------------------------------------------------------------------------

/// Returns the point at the fraction `t` of an edge of the unit cell.
Vec3 point_on(std::size_t edge, double t) {
  const auto [axis, corner] = mesh::cell_edges[edge];
  Vec3 point{static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1),
             static_cast<double>(corner >> 2 & 1)};
  point[axis] = t;
  return point;
}

std::vector<MeshTriangle> triangles_of(std::size_t inside) {
  std::vector<MeshTriangle> triangles;
  for (const mesh::CellTriangle& t : mesh::case_table()[inside].all())
    triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

/// Returns a fraction of an edge: anywhere, close to an end, or one of three values, so that points
/// are coplanar.
double random_fraction(Random& random, int how) {
  if (how == 0) return random.uniform(1e-6, 1 - 1e-6);
  if (how == 1) return std::array{1e-6, 0.5, 1 - 1e-6}[random.integer(0, 2)];
  const double distance = 1e-4 * random.uniform(0.01, 100);
  return random.chance(0.5) ? distance : 1 - distance;
}

enum class Signs : std::uint8_t { negative, positive, any };

/// Returns the signs that the orientation of points on four edges can have. The orientation is
/// linear in each of the four fractions. If it is not negative at the 16 choices of ends and
/// positive at one, it is hence positive for all points between the ends.
Signs signs_of(const std::array<std::size_t, 4>& edges) {
  bool is_negative = false, is_positive = false;
  for (std::size_t ends = 0; ends < 16; ++ends) {
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i)
      p[i] = point_on(edges[i], static_cast<double>(ends >> i & 1));
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    is_negative = is_negative || sign < 0;
    is_positive = is_positive || sign > 0;
  }
  if (is_negative == is_positive) return Signs::any;
  return is_positive ? Signs::positive : Signs::negative;
}

bool are_opposite(Signs one, Signs other) {
  return one != Signs::any && other != Signs::any && one != other;
}

/// Whether signs prove that a side without a corner of the triangle does not meet the triangle.
bool is_apart(std::size_t from, std::size_t to, const MeshTriangle& t) {
  const Signs of_from = signs_of({t[0], t[1], t[2], from}),
              of_to = signs_of({t[0], t[1], t[2], to});
  if (of_from != Signs::any && of_from == of_to) return true;
  const Signs a = signs_of({from, to, t[0], t[1]}), b = signs_of({from, to, t[1], t[2]}),
              c = signs_of({from, to, t[2], t[0]});
  return are_opposite(a, b) || are_opposite(b, c) || are_opposite(c, a);
}

bool has_corner(const MeshTriangle& t, std::uint64_t corner) {
  return std::ranges::find(t, corner) != t.end();
}

/// Whether signs prove that the sides of a triangle do not meet another one with at most one common
/// corner.
bool are_sides_apart(const MeshTriangle& of, const MeshTriangle& other) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t from = of[i], to = of[(i + 1) % 3];
    if (!has_corner(other, from) && !has_corner(other, to) && !is_apart(from, to, other))
      return false;
  }
  return true;
}

/// Whether the inside corners are a corner and its three neighbours. The polygon is then convex
/// along the diagonal of the cell at this corner.
bool is_corner_with_neighbours(std::size_t inside) {
  for (std::size_t corner = 0; corner < mesh::corner_count; ++corner) {
    std::size_t corners = std::size_t{1} << corner;
    for (std::size_t axis = 0; axis < 3; ++axis)
      corners |= std::size_t{1} << (corner ^ std::size_t{1} << axis);
    if (inside == corners) return true;
  }
  return false;
}

// --- meshes -------------------------------------------------------------------------------------

std::size_t count_intersections(const eses::Mesh& mesh) {
  return find_intersections(mesh.vertices, mesh.faces).size();
}

void check_meshes(const std::vector<Atom>& atoms, double probe_radius, double spacing,
                  double margin) {
  INFO("probe radius " << probe_radius << ", spacing " << spacing << ", margin " << margin);
  const eses::Surface surface(atoms, {.probe_radius = probe_radius});
  const Result result = eses::compute(surface, make_grid(surface, {spacing, margin}));
  const eses::Mesh plain = make_mesh(result), improved = make_quality_mesh(result);
  CHECK(count_intersections(plain) == 0);
  CHECK(count_intersections(improved) == 0);
  for (const eses::Mesh& mesh : {plain, improved})
    CHECK(find_mesh_faults(mesh.vertices.size(), mesh.faces).empty());
}

// --- combinations of options --------------------------------------------------------------------

std::string xyzr_of(std::span<const Atom> atoms) {
  std::string text;
  for (const auto& [center, radius] : atoms)
    text += fmt::format("{} {} {} {}\n", center.x, center.y, center.z, radius);
  return text;
}

/// Atoms that have cavities, in most cases.
std::vector<Atom> make_hollow_set(Random& random, std::uint64_t seed) {
  switch (random.integer(0, 2)) {
    case 0:
      return make_sponge(seed);
    case 1:
      return make_icosahedron(random.uniform(4, 5), random.uniform(1.8, 2.4));
    default:
      return make_atom_set(Kind::shell, seed);
  }
}

/// Chooses a mesh, and which cavities count as inside.
Request random_mesh_task(Random& random, std::uint64_t seed) {
  const std::vector<Atom> atoms = make_hollow_set(random, seed);
  Parameters parameters{.probe_radius = random.uniform(0.8, 1.5)};
  const double spacing = random.uniform(0.3, 0.8);
  parameters.grid = GridOptions{spacing, spacing * random.uniform(1.01, 2)};
  MeshOptions choice{.file = "mesh.ply", .quality = random.chance(0.6)};
  if (random.chance(0.4)) choice.color = MeshColor::component;
  if (random.chance(0.4)) {
    const std::size_t cavities =
        measure(eses::Surface(atoms), {.probe_radius = parameters.probe_radius, .cavities = true})
            .cavities.size();
    choice.component = static_cast<std::uint32_t>(random.integer(0, cavities));
  } else if (random.chance(0.5)) {
    parameters.max_filled_void = random.uniform(0, 60);
  }
  Request task{.atoms = atoms, .parameters = parameters, .outputs = Outputs::none()};
  task.outputs.mesh = choice;
  return task;
}

/// Chooses options that must not change the mesh.
void add_random_options(Random& random, Request& task) {
  task.parameters.threads = static_cast<int>(random.integer(1, 3));
  task.parameters.block_size = static_cast<std::int64_t>(random.integer(2, 40));
  task.resume = random.chance(0.6);
  if (task.outputs.mesh->component) return;
  task.parameters.exact = random.chance(0.4);
  task.outputs.edges = random.chance(0.5);
  task.outputs.gzip = random.chance(0.5);
  if (random.chance(0.3)) task.outputs.inside_map = "inside.dx.gz";
}

/// Performs a run in a directory and returns the mesh. The first attempt of a run that can be
/// resumed is interrupted after some blocks.
std::string mesh_bytes_of(Request task, Random& random, const std::filesystem::path& directory) {
  task.output_directory = directory;
  task.outputs.mesh->file = directory / "mesh.ply";
  const Processes alone;
  if (task.resume) {
    struct Interruption {};
    const double part = random.uniform(0, 1.2);
    const Callbacks callbacks{.progress = [&](std::int64_t done, std::int64_t all) {
      if (static_cast<double>(done) > part * static_cast<double>(all)) throw Interruption();
    }};
    try {
      PlannedRun run = plan_run(task, alone);
      execute(run, callbacks, alone);
    } catch (const Interruption&) {
      CHECK_FALSE(std::filesystem::exists(task.outputs.mesh->file));
    }
  }
  PlannedRun run = plan_run(task, alone);
  execute(run, {}, alone);
  return read_bytes(task.outputs.mesh->file);
}

std::uint64_t set_count() {
  constexpr std::uint64_t by_default = 500;
  const char* wanted = std::getenv("ESES_MESH_SETS");
  return wanted == nullptr ? by_default : std::stoull(wanted);
}

}  // namespace

TEST_CASE("mesh intersections: they are found", "[mesh]") {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0},      {0, 1, 0},
                                 {1, 1, 0}, {0.1, 0.1, -1}, {0.5, 0, 1},
                                 {0, 2, 1}, {0.5, 0.5, 0},  {0.2, 0.2, 0}};
  const auto meet = [&](const MeshTriangle& one, const MeshTriangle& other) {
    CHECK(do_intersect(points, one, other) == do_intersect(points, other, one));
    return do_intersect(points, one, other);
  };
  CHECK_FALSE(meet({0, 1, 2}, {1, 3, 2}));  // two halves of a square
  CHECK(meet({0, 1, 2}, {1, 8, 2}));        // a fold without a gap
  CHECK(meet({0, 1, 2}, {0, 1, 3}));        // coplanar, with a common side
  CHECK(meet({0, 1, 2}, {1, 2, 0}));        // the same one
  CHECK(meet({0, 1, 2}, {4, 5, 6}));        // a side passes through
  CHECK(meet({0, 1, 2}, {7, 5, 6}));        // a corner on a side
  CHECK(meet({0, 1, 2}, {8, 5, 6}));        // a corner within
  CHECK_FALSE(meet({0, 1, 2}, {0, 5, 6}));
  CHECK(meet({0, 1, 2}, {0, 7, 5}));  // a common corner, and a corner on the opposite side
  CHECK(meet({0, 1, 3}, {2, 7, 8}));  // coplanar
  // Rounding decides the sign of the determinant in double precision.
  const double e = 0x1p-52;
  CHECK(orientation({12, 12, 1}, {24, 24, 1 + e}, {0.5, 0.5 + e / 2, 2}, {0.5, 0.5, 3}) ==
        -orientation({24, 24, 1 + e}, {12, 12, 1}, {0.5, 0.5 + e / 2, 2}, {0.5, 0.5, 3}));
  CHECK(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-300}) == 1);
  CHECK(orientation({0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}, {0.7, 0.7, 0.7}, {1, 3, 8}) == 0);
}

TEST_CASE("mesh intersections: triangles of a cell do not meet, wherever the vertices are",
          "[mesh]") {
  Random random(3);
  for (std::size_t inside = 0; inside < mesh::case_count; ++inside) {
    INFO("case " << inside);
    const std::vector<MeshTriangle> triangles = triangles_of(inside);
    std::size_t intersections = 0;
    for (int i = 0; i < 300; ++i) {
      std::array<Vec3, mesh::edge_count> points;
      for (std::size_t edge = 0; edge < points.size(); ++edge)
        points[edge] = point_on(edge, random_fraction(random, i % 3));
      intersections += find_intersections(points, triangles).size();
    }
    CHECK(intersections == 0);
  }
}

TEST_CASE("mesh intersections: signs prove that triangles of six or seven vertices do not meet",
          "[mesh]") {
  std::size_t cases = 0;
  for (std::size_t inside = 0; inside < mesh::case_count; ++inside) {
    const std::vector<MeshTriangle> triangles = triangles_of(inside);
    std::set<std::uint64_t> vertices;
    for (const MeshTriangle& t : triangles) vertices.insert(t.begin(), t.end());
    // Only a single polygon has two vertices more than triangles.
    if (triangles.size() < 4 || vertices.size() != triangles.size() + 2) continue;
    if (is_corner_with_neighbours(inside)) continue;
    INFO("case " << inside);
    ++cases;
    for (const MeshTriangle& one : triangles)
      for (const MeshTriangle& other : triangles) {
        const auto common =
            std::ranges::count_if(one, [&](std::uint64_t v) { return has_corner(other, v); });
        if (common < 2) CHECK(are_sides_apart(one, other));
      }
  }
  CHECK(cases == 60);
}

TEST_CASE("mesh intersections: none in meshes of molecules", "[mesh][quality]") {
  const auto atoms_of = [](const char* file) {
    return read_atoms(std::string(ESES_DATA "/") + file).atoms;
  };
  // With the first triangulations of all polygons, the first two have intersections.
  check_meshes(atoms_of("1ubq.xyzr"), 1.5, 0.9274, 1.8548);
  check_meshes(atoms_of("mache.pqr"), 1.5, 1.3, 2.6);
  check_meshes(atoms_of("1ubq.xyzr"), 1.4, 0.4, 0.8);
  check_meshes(atoms_of("boxb.pqr"), 1.4, 0.4, 0.8);
}

TEST_CASE("mesh intersections: none in meshes of random and degenerate sets", "[mesh][quality]") {
  for (std::uint64_t seed = 0; seed < set_count(); ++seed) {
    Random random(seed);
    const double spacing = random.uniform(0.3, 1.3);
    const auto margin = [&] { return spacing * random.uniform(1.01, 2.5); };
    if (seed % 2 == 0) {
      const NearDegenerateSet set = make_near_degenerate_set(seed);
      INFO(set.name << ", noise " << set.noise << ", seed " << seed);
      check_meshes(set.atoms, set.probe_radius, spacing, margin());
    } else {
      const Kind kind = all_kinds[seed / 2 % all_kinds.size()];
      INFO(kind_name(kind) << ", seed " << seed);
      check_meshes(make_atom_set(kind, seed), designed_probe_radius(seed), spacing, margin());
    }
  }
}

TEST_CASE("mesh intersections: none with random combinations of options", "[mesh][quality]") {
  for (std::uint64_t seed = 0; seed < set_count() / 10; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    Request task = random_mesh_task(random, seed);
    const TemporaryDirectory plain, varied;
    const std::string expected = mesh_bytes_of(task, random, plain.path());
    write_file(plain.path() / "atoms.xyzr", xyzr_of(std::get<Molecule>(task.atoms).atoms()));
    task.atoms = InputFile{plain.path() / "atoms.xyzr"};
    add_random_options(random, task);
    const bool is_same = mesh_bytes_of(task, random, varied.path()) == expected;
    CHECK(is_same);
    const Mesh mesh = read_mesh(plain.path() / "mesh.ply");
    REQUIRE(!mesh.triangles.empty());
    CHECK(find_mesh_faults(mesh.positions.size(), mesh.triangles).empty());
    CHECK(find_intersections(mesh.positions, mesh.triangles).empty());
    const bool is_void = task.outputs.mesh->component.value_or(0) > 0;
    CHECK((measure(mesh).volume < 0) == is_void);
  }
}

}  // namespace eses::detail::test
