/// Tests of the mesh: its table of cases, its shape for any points, and its files.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/error.hpp"
#include "mesh/case_table.hpp"
#include "mesh/triangulate.hpp"
#include "mesh/vertex.hpp"
#include "output/mesh_writer.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/mesh_files.hpp"
#include "support/run.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

namespace fs = std::filesystem;

// --- the table ----------------------------------------------------------------------------------

using Segment = std::pair<int, int>;  // from one edge of a cell to another

bool is_inside(std::size_t inside, std::size_t corner) { return (inside >> corner & 1) != 0; }

std::size_t upper_corner(const mesh::CellEdge& edge) {
  return edge.corner | std::size_t{1} << edge.axis;
}

/// Whether an edge lies in the face of the cell at `side` of `axis`.
bool lies_in_face(int edge, std::size_t axis, std::size_t side) {
  const mesh::CellEdge& e = mesh::cell_edges[static_cast<std::size_t>(edge)];
  return e.axis != axis && (e.corner >> axis & 1) == side;
}

int faces_of(const Segment& segment) {
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::size_t side : {0U, 1U})
      count += lies_in_face(segment.first, axis, side) && lies_in_face(segment.second, axis, side);
  return count;
}

/// Returns the sides of triangles that no other triangle of the cell has in the opposite direction.
std::set<Segment> border_of(const mesh::CellCase& cell) {
  std::set<Segment> sides;
  for (const mesh::CellTriangle& t : cell.all())
    for (std::size_t i = 0; i < 3; ++i) {
      const bool is_new = sides.insert({t[i], t[(i + 1) % 3]}).second;
      CHECK(is_new);
    }
  std::set<Segment> border;
  for (const Segment& side : sides)
    if (!sides.contains({side.second, side.first})) border.insert(side);
  return border;
}

/// Returns the part of a cell's border in a face, optionally with the edge numbers of the neighbour
/// there.
std::set<Segment> border_in_face(const mesh::CellCase& cell, std::size_t axis, std::size_t side,
                                 bool as_neighbour) {
  const auto named = [&](int edge) {
    if (!as_neighbour) return edge;
    const mesh::CellEdge& e = mesh::cell_edges[static_cast<std::size_t>(edge)];
    for (std::size_t i = 0; i < mesh::edge_count; ++i)
      if (mesh::cell_edges[i].axis == e.axis &&
          mesh::cell_edges[i].corner == (e.corner ^ std::size_t{1} << axis))
        return static_cast<int>(i);
    return -1;
  };
  std::set<Segment> result;
  for (const auto& [from, to] : border_of(cell))
    if (lies_in_face(from, axis, side) && lies_in_face(to, axis, side))
      result.insert({named(from), named(to)});
  return result;
}

/// Returns the inside corners of the face at `side` as bits, in the same order on both sides.
std::size_t face_corners(std::size_t inside, std::size_t axis, std::size_t side) {
  std::size_t bits = 0, count = 0;
  for (std::size_t corner = 0; corner < mesh::corner_count; ++corner)
    if ((corner >> axis & 1) == side)
      bits |= static_cast<std::size_t>(is_inside(inside, corner)) << count++;
  return bits;
}

// --- grids of points ----------------------------------------------------------------------------

struct PointGrid {
  GridIndex size{};
  std::vector<bool> inside;  // x fastest, then y, then z

  bool at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    if (x >= size[0] || y >= size[1] || z >= size[2]) return false;
    return inside[static_cast<std::size_t>((z * size[1] + y) * size[0] + x)];
  }
};

/// Makes a grid whose points are outside on the border and random elsewhere.
PointGrid random_grid(Random& random) {
  PointGrid grid;
  for (std::int64_t& n : grid.size) n = static_cast<std::int64_t>(random.integer(3, 9));
  if (random.chance(0.2)) grid.size[0] += 60;  // more points than a word has bits
  const double density = random.uniform(0.05, 0.95);
  for (std::int64_t z = 0; z < grid.size[2]; ++z)
    for (std::int64_t y = 0; y < grid.size[1]; ++y)
      for (std::int64_t x = 0; x < grid.size[0]; ++x) {
        const bool is_border = x == 0 || y == 0 || z == 0 || x + 1 == grid.size[0] ||
                               y + 1 == grid.size[1] || z + 1 == grid.size[2];
        grid.inside.push_back(!is_border && random.chance(density));
      }
  return grid;
}

/// Makes the mesh of a grid with crossings at random places on their edges.
Mesh mesh_of(const PointGrid& grid, Random& random) {
  Mesh result;
  std::vector<mesh::Row> rows;
  for (std::int64_t z = 0; z < grid.size[2]; ++z)
    for (std::int64_t y = 0; y < grid.size[1]; ++y) {
      mesh::Row& row = rows.emplace_back();
      row.first_vertex = result.positions.size();
      row.inside.resize(static_cast<std::size_t>((grid.size[0] + 63) / 64));
      for (std::int64_t x = 0; x < grid.size[0]; ++x) {
        const bool inside = grid.at(x, y, z);
        if (inside) row.inside[static_cast<std::size_t>(x / 64)] |= std::uint64_t{1} << (x % 64);
        const std::array<bool, 3> ends{grid.at(x + 1, y, z), grid.at(x, y + 1, z),
                                       grid.at(x, y, z + 1)};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (ends[axis] == inside) continue;
          row.edges.push_back(mesh::edge_key(static_cast<std::uint64_t>(x), axis));
          Vec3 position{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
          position[axis] += random.uniform(0.01, 0.99);
          result.positions.push_back(position);
        }
      }
    }
  const auto row_at = [&](std::int64_t y, std::int64_t z) {
    return &rows[static_cast<std::size_t>(z * grid.size[1] + y)];
  };
  mesh::EdgeVertices edge_vertices;
  for (std::int64_t z = 0; z + 1 < grid.size[2]; ++z)
    for (std::int64_t y = 0; y + 1 < grid.size[1]; ++y)
      mesh::triangulate({row_at(y, z), row_at(y + 1, z), row_at(y, z + 1), row_at(y + 1, z + 1)},
                        grid.size[0], edge_vertices, result.triangles);
  return result;
}

/// Returns how often the mesh winds around a point, from the solid angles of its triangles: A. van
/// Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983), 125-126,
/// doi:10.1109/TBME.1983.325207.
double winding_number(const Mesh& mesh, Vec3 point) {
  double angle = 0;
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - point, b = mesh.positions[t[1]] - point,
               c = mesh.positions[t[2]] - point;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)),
                            la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

// --- runs ---------------------------------------------------------------------------------------

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

void check_no_faults(const Mesh& mesh) {
  const std::vector<std::string> faults = find_mesh_faults(mesh.positions.size(), mesh.triangles);
  INFO(faults.size() << " faults, the first: " << (faults.empty() ? "" : faults.front()));
  CHECK(faults.empty());
}

std::string bytes_of_mesh(const std::vector<Atom>& atoms, const Parameters& parameters,
                          MeshOptions choice) {
  const TemporaryDirectory directory;
  choice.file = directory.path() / choice.file;
  Outputs none = Outputs::none();
  none.mesh = choice;
  run(atoms, parameters, none, directory.path());
  return read_bytes(choice.file);
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

TEST_CASE("mesh: each case of the table cuts exactly the edges whose ends differ", "[mesh]") {
  for (std::size_t inside = 0; inside < mesh::case_count; ++inside) {
    INFO("case " << inside);
    std::set<int> used;
    for (const mesh::CellTriangle& t : mesh::case_table()[inside].all())
      used.insert(t.begin(), t.end());
    for (std::size_t e = 0; e < mesh::edge_count; ++e) {
      const mesh::CellEdge& edge = mesh::cell_edges[e];
      const bool differ = is_inside(inside, edge.corner) != is_inside(inside, upper_corner(edge));
      CHECK(used.contains(static_cast<int>(e)) == differ);
    }
  }
}

TEST_CASE("mesh: sides of triangles lie in exactly one face, diagonals in none", "[mesh]") {
  for (std::size_t inside = 0; inside < mesh::case_count; ++inside) {
    INFO("case " << inside);
    const mesh::CellCase& cell = mesh::case_table()[inside];
    const std::set<Segment> border = border_of(cell);
    std::map<int, int> from, to;
    for (const Segment& side : border) {
      CHECK(faces_of(side) == 1);
      ++from[side.first];
      ++to[side.second];
    }
    for (const mesh::CellTriangle& t : cell.all())
      for (std::size_t i = 0; i < 3; ++i) {
        const Segment side{t[i], t[(i + 1) % 3]};
        if (!border.contains(side)) CHECK(faces_of(side) == 0);
        // One polygon enters each vertex and leaves it.
        CHECK(from[t[i]] == 1);
        CHECK(to[t[i]] == 1);
      }
  }
}

TEST_CASE("mesh: cells that share a face have the same segments in it", "[mesh]") {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The segments that the first case with these corners has in the face.
    std::map<std::size_t, std::set<Segment>> lower, upper;
    for (std::size_t inside = 0; inside < mesh::case_count; ++inside) {
      const mesh::CellCase& cell = mesh::case_table()[inside];
      const auto check = [&](auto& known, std::size_t side, bool as_neighbour) {
        const std::size_t corners = face_corners(inside, axis, side);
        const std::set<Segment> border = border_in_face(cell, axis, side, as_neighbour);
        const auto [found, is_new] = known.try_emplace(corners, border);
        if (!is_new) CHECK(found->second == border);
      };
      check(lower, 0, false);
      check(upper, 1, true);
    }
    REQUIRE(lower.size() == 16);
    for (const auto& [corners, border] : lower) {
      std::set<Segment> reversed;
      for (const auto& [from, to] : border) reversed.insert({to, from});
      INFO("axis " << axis << ", corners " << corners);
      CHECK(upper[corners] == reversed);
    }
  }
}

TEST_CASE("mesh: the mesh of any points is closed, oriented and 2-manifold", "[mesh]") {
  Random random(20190611);
  for (int i = 0; i < 200; ++i) {
    INFO("grid " << i);
    const Mesh mesh = mesh_of(random_grid(random), random);
    check_no_faults(mesh);
  }
}

TEST_CASE("mesh: the mesh winds once around inside points and not around the others", "[mesh]") {
  Random random(7);
  for (int i = 0; i < 10; ++i) {
    const PointGrid grid = random_grid(random);
    const Mesh mesh = mesh_of(grid, random);
    for (int p = 0; p < 20; ++p) {
      const auto index = [&](std::size_t axis) {
        return static_cast<std::int64_t>(
            random.integer(0, static_cast<std::size_t>(grid.size[axis] - 1)));
      };
      const std::int64_t x = index(0), y = index(1), z = index(2);
      const Vec3 point{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
      CHECK(winding_number(mesh, point) == Approx(grid.at(x, y, z) ? 1 : 0).margin(1e-9));
    }
  }
}

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
      const double depth = make_plan(atoms, parameters, {}).cut_depth;
      const Mesh mesh = run_mesh(atoms, parameters).mesh;
      const bool is_closed = find_mesh_faults(mesh.positions.size(), mesh.triangles).empty();
      if (!is_closed) ++open;
      CHECK((is_closed || depth >= 0));
      CHECK((gap < 1e-9 || depth < 0));
    }
  }
  CHECK(open > 10);
}

TEST_CASE("mesh: the size of the file is estimated", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(200, 5);
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Outputs outputs;
    outputs.mesh = MeshOptions{name};
    const Plan plan = make_plan(atoms, {}, outputs);
    const double ratio = static_cast<double>(plan.files.mesh) /
                         static_cast<double>(bytes_of_mesh(atoms, {}, *outputs.mesh).size());
    INFO(name << ": " << ratio);
    CHECK(ratio > 0.7);
    CHECK(ratio < 1.6);
    CHECK(plan.files.output() ==
          plan.files.box + plan.files.grid + plan.files.edges + plan.files.areas + plan.files.mesh);
  }
}

TEST_CASE("mesh: the bytes do not depend on threads and block size", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(120, 20180102);
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Parameters parameters;
    parameters.threads = 1;
    parameters.block_size = 64;
    const MeshOptions choice{name};
    const std::string reference = bytes_of_mesh(atoms, parameters, choice);
    REQUIRE(reference.size() > 10000);
    for (const int threads : {1, 3})
      for (const std::int64_t block_size : {2, 9, 33, 1000}) {
        INFO(name << ", " << threads << " threads, block size " << block_size);
        parameters.threads = threads;
        parameters.block_size = block_size;
        const bool same = bytes_of_mesh(atoms, parameters, choice) == reference;
        CHECK(same);
      }
  }
}

TEST_CASE("mesh: all formats have the same vertices and triangles", "[mesh]") {
  const std::vector<Atom> atoms = make_chain(30, 3);
  const TemporaryDirectory directory;
  std::vector<Mesh> meshes;
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    Outputs outputs = Outputs::none();
    outputs.mesh = MeshOptions{directory.path() / name};
    const Summary summary = run(atoms, {}, outputs, directory.path());
    CHECK(summary.bytes_written == fs::file_size(directory.path() / name));
    meshes.push_back(read_mesh(directory.path() / name));
  }
  const Mesh& ply = meshes[0];
  REQUIRE(!ply.triangles.empty());
  for (const Mesh& other : meshes) {
    CHECK(other.triangles == ply.triangles);
    REQUIRE(other.positions.size() == ply.positions.size());
    for (std::size_t v = 0; v < ply.positions.size(); ++v)
      REQUIRE(norm(other.positions[v] - ply.positions[v]) < 1e-10);
  }
  REQUIRE(meshes[1].normals.size() == ply.normals.size());
  for (std::size_t v = 0; v < ply.normals.size(); ++v)
    REQUIRE(norm(meshes[1].normals[v] - ply.normals[v]) < 1e-6);
}

TEST_CASE("mesh: chains, residues and colours are those of the atoms", "[mesh]") {
  const Molecule molecule = make_two_chains();
  const std::vector<std::uint32_t> chains{0, 0, 1, 0}, residues{0, 0, 1, 2};
  const TemporaryDirectory directory;
  const auto mesh_in = [&](MeshColor color) {
    Outputs outputs;
    outputs.mesh = MeshOptions{directory.path() / "a.ply", color};
    run(molecule, {}, outputs, directory.path());
    return read_mesh(directory.path() / "a.ply");
  };
  const Mesh mesh = mesh_in(MeshColor::chain);
  REQUIRE(mesh.chains.size() == mesh.positions.size());
  REQUIRE(mesh.colors.size() == mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    REQUIRE(mesh.chains[v] == chains[mesh.atoms[v]]);
    REQUIRE(mesh.residues[v] == residues[mesh.atoms[v]]);
  }
  for (const char* comment : {"chain 0 B", "chain 1 A", "residue 0 ALA 52A B", "residue 1 GLY 1 A",
                              "residue 2 GLY 53 B"}) {
    INFO(comment);
    CHECK(std::count(mesh.comments.begin(), mesh.comments.end(), comment) == 1);
  }
  const auto colours_by = [](const Mesh& coloured, const auto& values) {
    std::map<std::int64_t, std::set<std::array<int, 3>>> seen;
    for (std::size_t v = 0; v < coloured.colors.size(); ++v)
      seen[values[v]].insert(coloured.colors[v]);
    std::set<std::array<int, 3>> all;
    for (const auto& [value, colors] : seen) {
      CHECK(colors.size() == 1);
      all.insert(colors.begin(), colors.end());
    }
    CHECK(all.size() == seen.size());
    return seen.size();
  };
  CHECK(colours_by(mesh, mesh.chains) == 2);
  const Mesh by_atom = mesh_in(MeshColor::atom), by_patch = mesh_in(MeshColor::patch);
  CHECK(colours_by(by_atom, by_atom.atoms) == 4);
  CHECK(colours_by(by_patch, by_patch.patches) >= 2);
}

namespace {

std::string header_of(const mesh::MeshText& text, const MeshCounts& counts) {
  std::string header;
  BufferedText part([&](std::string_view passed) { header += passed; });
  text.append_header_begin(part);
  text.append_header_end(part, counts, {});
  part.flush();
  return header;
}

}  // namespace

TEST_CASE("mesh: the header's length does not depend on the counts", "[mesh]") {
  for (const MeshFormat format : {MeshFormat::ply, MeshFormat::obj, MeshFormat::off}) {
    const mesh::MeshText text(format, MeshColor::none, {});
    const std::uint64_t expected = header_of(text, {0, 0}).size();
    for (const std::uint64_t count : {1ULL, 99ULL, 2147483647ULL, 99999999999ULL})
      CHECK(header_of(text, {count, 2 * count}).size() == expected);
  }
}

TEST_CASE("mesh: the counts of an OFF file are separated by single blanks", "[mesh]") {
  // The format allows any white space, but meshio splits the stripped line at each blank.
  const mesh::MeshText text(MeshFormat::off, MeshColor::none, {});
  for (const std::uint64_t count : {1ULL, 99ULL, 2147483647ULL}) {
    const std::string header = header_of(text, {count, 2 * count});
    const std::string begin = fmt::format("OFF\n{} {} 0", count, 2 * count);
    INFO(header);
    REQUIRE(header.rfind(begin, 0) == 0);
    CHECK(header.find_first_not_of(' ', begin.size()) == header.size() - 1);
    CHECK(header.back() == '\n');
  }
}

TEST_CASE("mesh: invalid outputs are refused", "[mesh]") {
  CHECK_NOTHROW(mesh::require_vertex_count(2147483647));
  CHECK_THROWS_AS(mesh::require_vertex_count(2147483648), Error);
  const std::vector<Atom> atoms{{{0, 0, 0}, 1.5}};
  Outputs outputs;
  outputs.mesh = MeshOptions{"a.xyz"};
  CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
  outputs.mesh = MeshOptions{"a.ply", MeshColor::chain};
  CHECK_THROWS_AS(make_plan(atoms, {}, outputs), std::invalid_argument);
  for (const char* name : {"a.ply", "b/a.PLY", "a.b.Ply"})
    CHECK(mesh_format(name) == MeshFormat::ply);
  CHECK(mesh_format("a.ply/b") == std::nullopt);
}

// --- the program --------------------------------------------------------------------------------

TEST_CASE("mesh: the program writes only the mesh at the given path", "[mesh][cli]") {
  const Sandbox sandbox;
  const auto names_in = [&](const char* below) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(sandbox.directory() / below))
      names.insert(entry.path().filename().string());
    return names;
  };
  const Outcome outcome =
      sandbox.run({"pair.xyzr", "--mesh", "meshes/a.ply", "-o", "out", "--color", "atom"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(names_in("meshes") == std::set<std::string>{"a.ply"});
  CHECK(names_in("out").size() == 4);
  CHECK(contains(outcome.out, " to out (bounding_box.txt"));
  CHECK(contains(outcome.out, " and to meshes/a.ply\n"));
  const Mesh mesh = read_mesh(sandbox.directory() / "meshes/a.ply");
  CHECK(contains(outcome.out, "mesh: " + std::to_string(mesh.positions.size()) + " vertices, " +
                                  std::to_string(mesh.triangles.size()) + " triangles\n"));

  // The mesh is written into the directory of the other files, named by different paths, and alone.
  CHECK(sandbox.run({"pair.xyzr", "--mesh", "./out/../out/b.obj", "-o", "out"}).code == 0);
  CHECK(names_in("out").size() == 5);
  CHECK(sandbox.run({"pair.xyzr", "--mesh", "alone/c.off", "--write", "none"}).code == 0);
  CHECK(names_in("alone") == std::set<std::string>{"c.off"});
  CHECK(sandbox.files().empty());
}

TEST_CASE("mesh: the JSON report and the plan have the mesh", "[mesh][cli]") {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"pair.xyzr", "--mesh", "a.ply", "--json"});
  REQUIRE(outcome.code == 0);
  check_json(sandbox, outcome.out, "r['mesh']['file']", "'a.ply'");
  check_json(sandbox, outcome.out, "r['mesh']['triangles'] == 2 * r['mesh']['vertices'] - 4",
             "True");
  check_json(sandbox, outcome.out, "r['mesh']['vertices'] == r['crossings']['total']", "True");
  check_json(sandbox, outcome.out, "r['plan']['mesh_file_bytes'] > 10000", "True");
  check_json(sandbox, outcome.out, "0 < r['plan']['scratch_bytes'] < r['plan']['mesh_file_bytes']",
             "True");
  check_json(sandbox, outcome.out, "r['output']['files'][-2:]", "['partition_area.txt', 'a.ply']");
  check_json(sandbox,
             sandbox.run({"pair.xyzr", "--mesh", "out/a.ply", "--json", "-o", "./out"}).out,
             "r['output']['files'][-1]", "'a.ply'");
  const Outcome elsewhere =
      sandbox.run({"pair.xyzr", "--mesh", "far/a.ply", "--json", "--write", "none", "-o", "out"});
  check_json(sandbox, elsewhere.out, "r['output']['files']",
             "['" + (sandbox.directory() / "far/a.ply").string() + "']");
  check_json(sandbox, sandbox.run({"pair.xyzr", "--json", "-q"}).out, "r['mesh']", "None");
  const Outcome plan = sandbox.run({"pair.xyzr", "--mesh", "b.ply", "--dry-run"});
  CHECK(contains(plan.out, "the mesh about "));
  CHECK_FALSE(fs::exists(sandbox.directory() / "b.ply"));
}

TEST_CASE("mesh: errors leave no mesh and name the path", "[mesh][cli]") {
  const Sandbox sandbox;
  const auto check = [&](const Arguments& arguments, int code, const std::string& message) {
    INFO(Sandbox::command(arguments));
    const Outcome outcome = sandbox.run(arguments);
    CHECK(outcome.code == code);
    INFO(outcome.err);
    CHECK(contains(outcome.err, message));
    CHECK(sandbox.files().empty());
  };
  check({"pair.xyzr", "--mesh", "a.stp"}, 2,
        "--mesh is 'a.stp', expected a file with the suffix .ply, .obj, .off, .vtp, .stl, .glb, "
        ".vert "
        "or .face");
  check({"pair.xyzr", "--mesh", ""}, 2, "--mesh is ''");
  check({"pair.xyzr", "--mesh"}, 2, "--mesh needs a value");
  check({"pair.xyzr", "--color", "atom"}, 2,
        "--color needs --mesh with a .ply, .obj, .vtp or .glb file");
  check({"pair.xyzr", "--mesh", "a.vert", "--color", "atom"}, 2,
        "--color needs --mesh with a .ply");
  for (const char* file : {"a.obj", "a.off", "a.vtp", "a.stl", "a.glb", "a.face"})
    check({"pair.xyzr", "--mesh", file, "--ply-ascii"}, 2,
          "--ply-ascii needs --mesh with a .ply file");
  check({"pair.xyzr", "--ply-ascii"}, 2, "--ply-ascii needs --mesh with a .ply file");
  for (const char* file : {"a.off", "a.stl"})
    check({"pair.xyzr", "--mesh", file, "--color", "atom"}, 2, "--color needs --mesh");
  check({"pair.xyzr", "--mesh", "a.ply", "--color", "red"}, 2,
        "--color is 'red', expected patch, atom, chain, potential or component");
  for (const char* file : {"pair.xyzr", "missing.xyzr", "-"})
    check({file, "--mesh", "a.ply", "--color", "chain"}, 2,
          "--color chain needs a PQR, PDB or mmCIF file");
  check({"missing.PQR.gz", "--mesh", "a.ply", "--color", "chain"}, 1, "missing.PQR.gz");
  check({"missing.xyzr", "--format", "pqr", "--mesh", "a.ply", "--color", "chain"}, 1,
        "missing.xyzr");
  check({"missing.pqr", "--format", "xyzr", "--mesh", "a.ply", "--color", "chain"}, 2,
        "--color chain needs a PQR, PDB or mmCIF file");
  check({"pair.xyzr", "--mesh", "pair.xyzr/a.ply"}, 1, "cannot write into pair.xyzr");
  fs::create_directory(sandbox.directory() / "taken.ply");
  check({"pair.xyzr", "--mesh", "taken.ply"}, 1, "taken.ply");
  fs::create_symlink("b.ply", sandbox.directory() / "a.ply");
  fs::create_symlink("a.ply", sandbox.directory() / "b.ply");
  check({"pair.xyzr", "--mesh", "a.ply"}, 1, "cannot write a.ply");
}

TEST_CASE("mesh: only a regular file is replaced", "[mesh][cli]") {
  const Sandbox sandbox;
  const SpecialFiles special(sandbox.directory());
  for (const auto& [file, kind] : special.kinds) {
    for (const bool is_link : {false, true}) {
      const fs::path mesh = sandbox.directory() / "a.ply";
      if (is_link) {
        fs::create_symlink(file, sandbox.directory() / "b.ply");
        fs::create_symlink("b.ply", mesh);
      } else if (file.parent_path() == sandbox.directory()) {
        fs::rename(file, mesh);
      } else {
        continue;
      }
      for (const char* more : {"-q", "--dry-run", "--resume"}) {
        INFO(kind << (is_link ? " by links " : " ") << more);
        const Outcome outcome =
            sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "a.ply", more});
        CHECK(outcome.code == 1);
        CHECK(outcome.out.empty());
        CHECK(outcome.err == "eses-blocks: error: cannot write a.ply: it is " + kind +
                                 ", not a regular file; choose another name\n");
        CHECK(fs::is_symlink(fs::symlink_status(mesh)) == is_link);
        CHECK_FALSE(fs::is_regular_file(mesh));
      }
      if (is_link) {
        fs::remove(mesh);
        fs::remove(sandbox.directory() / "b.ply");
      } else {
        fs::rename(mesh, file);
      }
    }
  }
}

TEST_CASE("mesh: a symbolic link stays, and its target is written", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directory(sandbox.directory() / "far");
  const auto link = [&](const char* name, const char* target) {
    fs::create_symlink(target, sandbox.directory() / name);
  };
  link("a.ply", "far/b.ply");
  link("far/b.ply", "../c.ply");  // a target that does not exist yet
  link("d.ply", (sandbox.directory() / "far/data.with.any.name").c_str());
  REQUIRE(sandbox.run({"pair.xyzr", "--write", "none", "--mesh", "plain.ply"}).code == 0);
  const std::string mesh = read_file(sandbox.directory() / "plain.ply");
  for (const auto& [name, target] : {std::pair("a.ply", "c.ply"), std::pair("a.ply", "c.ply"),
                                     std::pair("d.ply", "far/data.with.any.name")}) {
    INFO(name);
    const Outcome outcome = sandbox.run({"pair.xyzr", "--write", "none", "--mesh", name});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(fs::is_symlink(sandbox.directory() / name));
    CHECK(fs::is_symlink(sandbox.directory() / "far/b.ply"));
    CHECK(fs::is_regular_file(fs::symlink_status(sandbox.directory() / target)));
    CHECK(read_file(sandbox.directory() / target) == mesh);
  }
}

TEST_CASE("mesh: a dry run refuses paths that cannot be written, and creates none", "[mesh][cli]") {
  const Sandbox sandbox;
  fs::create_directories(sandbox.directory() / "taken.ply");
  fs::create_directories(sandbox.directory() / "out/map.dx");
  const std::string long_name = std::string(252, 'a') + ".ply";
  for (const Arguments& arguments :
       {Arguments{"--mesh", "pair.xyzr/a.ply"}, Arguments{"--mesh", "pair.xyzr/b/a.ply"},
        Arguments{"--mesh", "taken.ply"}, Arguments{"--mesh", long_name},
        Arguments{"--inside", "a.vti", "-o", "pair.xyzr/out"},
        Arguments{"--inside", "map.dx", "-o", "out"}, Arguments{"-o", "pair.xyzr"}}) {
    Arguments run{"pair.xyzr"};
    run.insert(run.end(), arguments.begin(), arguments.end());
    INFO(Sandbox::command(run));
    const Outcome refused = sandbox.run(run);
    run.emplace_back("--dry-run");
    const Outcome dry = sandbox.run(run);
    CHECK(refused.code == 1);
    CHECK(dry.code == 1);
    CHECK(dry.err == refused.err);
    CHECK(dry.out.empty());
  }
  const Outcome good = sandbox.run({"pair.xyzr", "--mesh", "new/place/a.ply", "-o", "other/new",
                                    "--inside", "m.dx", "--dry-run"});
  CHECK(good.code == 0);
  CHECK_FALSE(fs::exists(sandbox.directory() / "new"));
  CHECK_FALSE(fs::exists(sandbox.directory() / "other"));
}

}  // namespace eses::detail::test
