// Intersections of new triangles with the triangles near them.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "mesh/quality_mesh.hpp"
#include "mesh/quality_rules.hpp"

namespace eses::detail::mesh {

// Returns whether one of `new_triangles_`, which replace `old_faces_` within `bounds`, intersects
// another triangle.
bool QualityMesh::do_intersect(const Bounds& bounds) {
  list_near_faces(bounds);
  Vec3 direction;
  for (const Corners& triangle : new_triangles_)
    direction = direction + area_vector(points(triangle));
  const double largest =
      std::max({std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)});
  const auto faces_direction = [&](const Corners& triangle) {
    const auto [a, b, c] = points(triangle);
    return dot(direction, area_vector(a, b, c)) > largest * area_error(a, b, c);
  };
  const auto is_of_graph = [&](Index face) { return faces_direction(faces_[face].vertices); };
  if (std::ranges::all_of(new_triangles_, faces_direction) &&
      std::ranges::all_of(old_faces_, is_of_graph) &&
      std::ranges::all_of(near_faces_, is_of_graph, &NearFace::face))
    return false;
  for (std::size_t i = 0; i < new_triangles_.size(); ++i) {
    const Bounds box(points(new_triangles_[i]));
    for (std::size_t j = 0; j < i; ++j)
      if (intersect(new_triangles_[i], new_triangles_[j])) return true;
    for (const auto& [face, face_box] : near_faces_)
      if (box.overlaps(face_box) && intersect(new_triangles_[i], faces_[face].vertices))
        return true;
  }
  return false;
}

// Returns the first vertex of a row [begin, end) whose x is at least `low_x`.
QualityMesh::Index QualityMesh::first_from(double low_x, Index begin, Index end) const {
  for (Index count = end - begin; count > 0;) {
    const Index half = count / 2;
    const bool is_before = position(begin + half).x < low_x;
    if (is_before) begin += half + 1;
    count = is_before ? count - half - 1 : half;
  }
  return begin;
}

// Lists the triangles that overlap a box, except `old_faces_`.
void QualityMesh::list_near_faces(const Bounds& bounds) {
  near_faces_.clear();
  // A point of a triangle is at most 1 / sqrt(3) of the longest side away from the nearest corner.
  const double reach = max_edge * grid_.spacing / std::numbers::sqrt3;
  Bounds wide_bounds = bounds;
  wide_bounds.extend(bounds.low - Vec3{reach, reach, reach});
  wide_bounds.extend(bounds.high + Vec3{reach, reach, reach});
  const auto is_near = [&](const Vertex& vertex) {
    return wide_bounds.overlaps(Bounds(vertex.position));
  };
  // Rounding may move a vertex beyond its row or plane.
  constexpr double rounding = 0.001;
  const auto index = [&](double coordinate, std::size_t axis, std::int64_t begin, double offset) {
    return static_cast<std::int64_t>(
               std::floor((coordinate - grid_.origin[axis]) / grid_.spacing + offset)) -
           begin;
  };
  const std::int64_t low_z = index(wide_bounds.low.z, 2, 0, -rounding),
                     high_z = index(wide_bounds.high.z, 2, 0, rounding),
                     low_y = index(wide_bounds.low.y, 1, region_.begin[1], -rounding),
                     high_y = index(wide_bounds.high.y, 1, region_.begin[1], rounding);
  // Within a row, the vertices are sorted by x up to a spacing.
  const double low_x = wide_bounds.low.x - grid_.spacing,
               high_x = wide_bounds.high.x + grid_.spacing;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    const Plane& plane = planes_[p];
    if (plane.z < low_z || plane.z > high_z) continue;
    const Index plane_end = end_of(p);
    const auto begin_of = [&](std::int64_t y) {
      const auto row = static_cast<std::size_t>(y);
      return row < plane.rows.size() ? plane.rows[row] : plane_end;
    };
    for (std::int64_t y = std::max<std::int64_t>(0, low_y); y <= high_y; ++y) {
      const Index end = begin_of(y + 1);
      for (Index next = first_from(low_x, begin_of(y), end);
           next != end && position(next).x <= high_x; ++next) {
        const Vertex& vertex = vertices_[next];
        if (vertex.is_removed || !is_near(vertex)) continue;
        for (const Index corner : vertex.corners()) {
          if (!is_in_window(corner)) continue;
          const Corners& triangle = faces_[corner >> 2].vertices;
          // The first corner that is near lists the triangle.
          const auto earlier = std::span(triangle).first(corner & 3);
          if (std::ranges::any_of(earlier, [&](Index v) { return is_near(vertices_[v]); }))
            continue;
          const Bounds box(points(triangle));
          if (box.overlaps(bounds) &&
              std::ranges::find(old_faces_, corner >> 2) == old_faces_.end())
            near_faces_.push_back({corner >> 2, box});
        }
      }
    }
  }
}

// Returns whether two triangles have common points besides common corners and edges.
bool QualityMesh::intersect(const Corners& one, const Corners& other) const {
  std::size_t common = 0, of_one = 0, of_other = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (one[i] == other[j]) {
        ++common;
        of_one = i;
        of_other = j;
      }
  const TrianglePoints a = points(one), b = points(other);
  if (common == 3) return true;
  if (common == 2) {
    const Vec3 u = area_vector(a), v = area_vector(b);
    return dot(u, v) < fold * norm(u) * norm(v);
  }
  if (common == 1)
    return segment_meets_triangle(a[(of_one + 1) % 3], a[(of_one + 2) % 3], b) ||
           segment_meets_triangle(b[(of_other + 1) % 3], b[(of_other + 2) % 3], a);
  for (std::size_t i = 0; i < 3; ++i)
    if (segment_meets_triangle(a[i], a[(i + 1) % 3], b) ||
        segment_meets_triangle(b[i], b[(i + 1) % 3], a))
      return true;
  return false;
}

}  // namespace eses::detail::mesh
