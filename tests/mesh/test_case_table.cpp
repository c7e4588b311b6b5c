/// Tests of the table of cases of the mesh, and of meshes of any points.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/grid.hpp"
#include "mesh/case_table.hpp"
#include "mesh/triangulate.hpp"
#include "support/atom_sets.hpp"
#include "support/mesh_files.hpp"

namespace eses::detail::test {
namespace {

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

/// Returns the number of triangles at the middle edge of four cells that share it. Bit
/// 9 * i + 3 * j + k of `points` is set if the point at i along the edge, and at j and k along the
/// next two axes, is inside. The result is 0 if the edge has no vertex.
std::size_t triangles_at_edge(std::size_t axis, std::size_t points) {
  const std::size_t j_axis = (axis + 1) % 3, k_axis = (axis + 2) % 3;
  std::size_t count = 0;
  for (std::size_t cell = 0; cell < 4; ++cell) {
    const std::size_t j = cell & 1, k = cell >> 1;
    std::size_t inside = 0;
    for (std::size_t corner = 0; corner < mesh::corner_count; ++corner) {
      const std::size_t point =
          9 * (corner >> axis & 1) + 3 * (j + (corner >> j_axis & 1)) + k + (corner >> k_axis & 1);
      inside |= (points >> point & 1) << corner;
    }
    const std::size_t lower = (1 - j) << j_axis | (1 - k) << k_axis;
    const auto edge =
        static_cast<std::size_t>(std::ranges::find_if(mesh::cell_edges,
                                                      [&](const mesh::CellEdge& e) {
                                                        return e.axis == axis && e.corner == lower;
                                                      }) -
                                 mesh::cell_edges.begin());
    for (const mesh::CellTriangle& t : mesh::case_table()[inside].all())
      count += static_cast<std::size_t>(std::ranges::count(t, edge));
  }
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

TEST_CASE("mesh: a vertex has at most 17 triangles, whatever the points around its edge are",
          "[mesh]") {
  std::size_t most = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t points = 0; points < std::size_t{1} << 18U; ++points)
      most = std::max(most, triangles_at_edge(axis, points));
  CHECK(most == mesh::max_vertex_triangles);
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

}  // namespace eses::detail::test
