#include "mesh/case_table.hpp"

#include <algorithm>
#include <vector>

namespace eses::detail::mesh {
namespace {

using Face = std::array<std::size_t, 4>;
using Polygon = std::vector<std::uint8_t>;

constexpr std::size_t face_count = 6;

// The corners of each face, counterclockwise seen from outside the cell.
std::array<Face, face_count> make_faces() {
  std::array<Face, face_count> faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = std::size_t{1} << (axis + 1) % 3, v = std::size_t{1} << (axis + 2) % 3;
    const std::size_t upper = std::size_t{1} << axis;
    faces[2 * axis] = {0, v, u | v, u};
    faces[2 * axis + 1] = {upper, upper | u, upper | u | v, upper | v};
  }
  return faces;
}

std::uint8_t edge_between(std::size_t a, std::size_t b) {
  const std::size_t lower = std::min(a, b);
  const auto edge = std::find_if(cell_edges.begin(), cell_edges.end(), [&](const CellEdge& e) {
    return e.corner == lower && (std::size_t{1} << e.axis) == (a ^ b);
  });
  return static_cast<std::uint8_t>(edge - cell_edges.begin());
}

bool lies_in(std::uint8_t edge, const Face& face) {
  const auto [axis, corner] = cell_edges[edge];
  const auto is_corner = [&](std::size_t c) {
    return std::find(face.begin(), face.end(), c) != face.end();
  };
  return is_corner(corner) && is_corner(corner | std::size_t{1} << axis);
}

class Tabulator {
 public:
  Tabulator() : faces_(make_faces()) {}

  CellCase make_case(std::size_t inside) const {
    CellCase result;
    for (Polygon& polygon : polygons(inside)) {
      if (can_intersect_itself(polygon))
        std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
      std::vector<CellTriangle> triangles;
      triangulate_polygon(polygon, triangles);
      for (const CellTriangle& triangle : triangles) result.triangles[result.count++] = triangle;
    }
    return result;
  }

 private:
  static constexpr std::uint8_t none = edge_count;
  using Successors = std::array<std::uint8_t, edge_count>;

  // Returns the segments on the faces as a map from cell edge to the next cell edge of the polygon.
  // On a face, the boundary is followed counterclockwise. A segment starts at the cell edge at
  // which the boundary enters a run of inside corners, and ends where it leaves the run.
  Successors successors(std::size_t inside) const {
    Successors next;
    next.fill(none);
    const auto is_inside = [inside](std::size_t corner) { return (inside >> corner & 1) != 0; };
    for (const Face& face : faces_)
      for (std::size_t k = 0; k < face.size(); ++k) {
        const auto corner = [&](std::size_t i) { return face[i % face.size()]; };
        if (is_inside(corner(k)) || !is_inside(corner(k + 1))) continue;
        std::size_t end = k + 1;
        while (is_inside(corner(end + 1))) ++end;
        next[edge_between(corner(k), corner(k + 1))] = edge_between(corner(end), corner(end + 1));
      }
    return next;
  }

  std::vector<Polygon> polygons(std::size_t inside) const {
    Successors next = successors(inside);
    std::vector<Polygon> result;
    for (std::uint8_t start = 0; start < edge_count; ++start) {
      if (next[start] == none) continue;
      Polygon& polygon = result.emplace_back();
      for (std::uint8_t edge = start; next[edge] != none;) {
        polygon.push_back(edge);
        const std::uint8_t following = next[edge];
        next[edge] = none;
        edge = following;
      }
    }
    return result;
  }

  // Returns whether the triangles of the first triangulation of a polygon can intersect each other.
  // This zigzag connects the two segments of an ambiguous face, the sides [3, 4] and [6, 0]. The
  // first triangulation that begins at the next vertex has no such triangles.
  bool can_intersect_itself(const Polygon& polygon) const {
    return polygon.size() == 7 && lie_in_one_face(polygon[0], polygon[4]) &&
           lie_in_one_face(polygon[3], polygon[6]);
  }

  bool lie_in_one_face(std::uint8_t a, std::uint8_t b) const {
    return std::any_of(faces_.begin(), faces_.end(),
                       [&](const Face& face) { return lies_in(a, face) && lies_in(b, face); });
  }

  // Appends the triangles of the first allowed triangulation and returns true, or returns false if
  // there is none. Chooses the triangle at the polygon's last side, then recursively triangulates
  // the polygons on both sides of it. A diagonal is allowed if its ends do not lie in one face.
  bool triangulate_polygon(std::span<const std::uint8_t> polygon,
                           std::vector<CellTriangle>& triangles) const {
    if (polygon.size() < 3) return true;
    const std::size_t count = triangles.size(), last = polygon.size() - 1;
    for (std::size_t k = 1; k < last; ++k) {
      if (k > 1 && lie_in_one_face(polygon[0], polygon[k])) continue;
      if (k + 1 < last && lie_in_one_face(polygon[k], polygon[last])) continue;
      triangles.push_back({polygon[0], polygon[k], polygon[last]});
      if (triangulate_polygon(polygon.first(k + 1), triangles) &&
          triangulate_polygon(polygon.subspan(k), triangles))
        return true;
      triangles.resize(count);
    }
    return false;
  }

  std::array<Face, face_count> faces_;
};

std::array<CellCase, case_count> make_table() {
  const Tabulator tabulator;
  std::array<CellCase, case_count> table;
  for (std::size_t inside = 0; inside < case_count; ++inside)
    table[inside] = tabulator.make_case(inside);
  return table;
}

}  // namespace

const std::array<CellCase, case_count>& case_table() {
  static const std::array<CellCase, case_count> table = make_table();
  return table;
}

}  // namespace eses::detail::mesh
