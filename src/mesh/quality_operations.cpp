// Collapses and flips: which ones are possible, which one is best, and how the mesh changes.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "mesh/quality_mesh.hpp"
#include "mesh/quality_rules.hpp"

namespace eses::detail::mesh {

// Returns the smallest scalar product of the unit normal of a triangle with the normals of the
// surface at its corners.
double QualityMesh::facing(const Corners& triangle) const {
  const Vec3 area = area_vector(points(triangle));
  const double length = norm(area);
  if (length == 0) return -1;
  double least = length;
  for (const Index vertex : triangle) least = std::min(least, dot(area, vertices_[vertex].normal));
  return least / length;
}

// Returns whether `facing` is at least `min_facing`. `area` is the area vector.
bool QualityMesh::faces_outward(const Corners& triangle, const Vec3& area) const {
  double least = std::numeric_limits<double>::max();
  for (const Index vertex : triangle) least = std::min(least, dot(area, vertices_[vertex].normal));
  return least > 0 && least * least >= min_facing * min_facing * squared_norm(area);
}

// Whether all triangles at a vertex are in the window and may change.
bool QualityMesh::can_change(Index vertex) const {
  const std::int32_t z = vertices_[vertex].z;
  return frozen_ < z && z < plane_;
}

bool QualityMesh::can_have(const Face& face, Index vertex) const {
  return std::abs(vertices_[vertex].z - face.plane) <= max_drift;
}

// Returns the corner opposite to the same edge in the other triangle at the edge, or `none`.
QualityMesh::Index QualityMesh::corner_across(Index corner) const {
  const Index from = vertex_at(after(corner)), to = vertex_at(before(corner));
  for (Index other = vertices_[from].first_corner; other != none; other = next_corner(other))
    if (vertex_at(before(other)) == to) return after(other);
  return none;
}

// Marks the neighbours of a vertex, and lists its corners. The list is empty if the vertex must not
// be removed, as it is at the border of the mesh.
void QualityMesh::list_ring(Index vertex) {
  if (ring_center_ == vertex) return;
  ring_center_ = vertex;
  const Index mark = ++mark_;
  ring_.resize(vertices_[vertex].valence);
  Index corner = vertices_[vertex].first_corner;
  for (RingCorner& at : ring_) {
    const Face& face = faces_[corner >> 2];
    const Index i = corner & 3;
    at = {corner, face.vertices[i < 2 ? i + 1 : 0], face.vertices[i > 0 ? i - 1 : 2]};
    vertices_[at.left].mark = mark;
    corner = face.next[i];
  }
  for (const RingCorner& at : ring_)
    if (vertices_[at.right].mark != mark_) {
      ring_.clear();
      return;
    }
}

// Lists the ring of a vertex. From now on, new triangles must be better than its worst triangle.
void QualityMesh::list_ring_to_improve(Index vertex) {
  list_ring(vertex);
  limits_.min_quality = 1;
  for (const RingCorner& at : ring_)
    limits_.min_quality = std::min(limits_.min_quality, quality_of(at.corner >> 2));
}

// Returns whether a collapse of an edge would give its end too many neighbours.
bool QualityMesh::has_too_many_neighbors(Index from, Index to) const {
  return vertices_[from].valence + vertices_[to].valence - 4 > max_valence;
}

// Considers the collapse of `from`, whose ring is listed.
void QualityMesh::consider_collapse(Index from, Index to) {
  if (ring_.size() < 3 || !can_change(to)) return;
  // The lengths reject most candidates, and cost less than the shapes.
  const Vec3 end = position(to);
  for (const RingCorner& at : ring_)
    if (squared_norm(position(at.left) - end) > limits_.max_squared_length && at.right != to)
      return;
  if (!is_collapsible(to)) return;
  const float min_quality = std::max(limits_.min_quality, best_quality());
  float quality = 1;
  bool is_turned = false;
  for (const auto& [corner, left, right] : ring_) {
    if (left == to || right == to) continue;
    if (!can_have(faces_[corner >> 2], to)) return;
    const TrianglePoints t{end, position(left), position(right)};
    const Vec3 area = area_vector(t);
    quality = std::min(quality, quality_of_shape(t, area));
    if (quality <= min_quality) return;
    is_turned = is_turned || !faces_outward({to, left, right}, area);
  }
  if (is_turned) {
    double old_facing = 1, new_facing = 1;
    for (const auto& [corner, left, right] : ring_) {
      old_facing = std::min(old_facing, facing(faces_[corner >> 2].vertices));
      if (left != to && right != to) new_facing = std::min(new_facing, facing({to, left, right}));
    }
    if (new_facing < old_facing) return;
  }
  operations_.push_back({quality, false, from, to});
}

// Considers the two collapses of the edge opposite to a corner that improve the worst triangle.
void QualityMesh::consider_collapses(Index corner) {
  const std::array<Index, 2> ends{vertex_at(after(corner)), vertex_at(before(corner))};
  if (has_too_many_neighbors(ends[0], ends[1])) return;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!can_change(ends[i])) continue;
    list_ring_to_improve(ends[i]);
    consider_collapse(ends[i], ends[1 - i]);
  }
}

// Considers the collapses of a vertex into each of its neighbours that improve the worst triangle.
void QualityMesh::consider_all_collapses(Index vertex) {
  if (!can_change(vertex)) return;
  list_ring_to_improve(vertex);
  for (const RingCorner& at : ring_)
    if (!has_too_many_neighbors(vertex, at.left)) consider_collapse(vertex, at.left);
}

// Considers the flip of the edge opposite to a corner.
void QualityMesh::consider_flip(Index corner) {
  const Index other = corner_across(corner);
  if (other == none) return;
  const Index a = vertex_at(after(corner)), b = vertex_at(before(corner)), from = vertex_at(corner),
              to = vertex_at(other);
  const Face &one = faces_[corner >> 2], &two = faces_[other >> 2];
  if (from == to || !can_change(a) || !can_change(b) || !can_change(from) || !can_change(to) ||
      !can_have(one, to) || !can_have(two, from))
    return;
  if (vertices_[from].valence >= max_valence || vertices_[to].valence >= max_valence ||
      squared_norm(position(from) - position(to)) > limits_.max_squared_length)
    return;
  const Corners left{from, a, to}, right{from, to, b};
  const float quality = std::min(quality_of_shape(points(left)), quality_of_shape(points(right)));
  if (quality <= std::min(quality_of(corner >> 2), quality_of(other >> 2)) ||
      quality <= best_quality())
    return;
  const double new_facing = std::min(facing(left), facing(right));
  if (new_facing < min_facing && new_facing < std::min(facing(one.vertices), facing(two.vertices)))
    return;
  operations_.push_back({quality, true, corner, other});
}

// Performs the best operation that is possible. Returns false if there is none.
bool QualityMesh::perform_best() {
  for (; !operations_.empty(); operations_.pop_back())
    if (perform(operations_.back())) return true;
  return false;
}

// Returns whether the mesh stays a manifold if an edge at `from` is collapsed. The ring of `from`
// is listed. The two vertices opposite to the edge must be the only common neighbours.
bool QualityMesh::is_collapsible(Index to) const {
  std::array<Index, 2> opposite{none, none};
  for (const RingCorner& at : ring_) {
    if (at.left == to) opposite[0] = at.right;
    if (at.right == to) opposite[1] = at.left;
  }
  for (const Index vertex : opposite)
    if (vertex == none || vertices_[vertex].valence < 4) return false;
  for (Index corner = vertices_[to].first_corner; corner != none;) {
    const Face& face = faces_[corner >> 2];
    for (const Index vertex : face.vertices)
      if (vertices_[vertex].mark == mark_ && vertex != opposite[0] && vertex != opposite[1] &&
          vertex != to)
        return false;
    corner = face.next[corner & 3];
  }
  return true;
}

// Returns whether an edge connects two vertices.
bool QualityMesh::are_neighbors(Index one, Index other) const {
  for (Index corner = vertices_[one].first_corner; corner != none; corner = next_corner(corner))
    if (vertex_at(after(corner)) == other || vertex_at(before(corner)) == other) return true;
  return false;
}

// Performs an operation if there are no intersections. The mesh stays a manifold: collapses that
// would break it are not considered, and flips are checked here.
//
// If all triangles in the box of the old triangles face one direction, the surface in the box has a
// single sheet, which is a graph over a plane: two sheets of a closed surface that face the same
// direction have a third one between them that does not. New triangles that face this direction,
// too, are then part of a graph. Otherwise all pairs are compared.
bool QualityMesh::perform(const Operation& operation) {
  const auto [quality, is_flip, from, to] = operation;
  old_faces_.clear();
  new_triangles_.clear();
  Bounds bounds(position(is_flip ? vertex_at(from) : from));
  if (is_flip) {
    const Index a = vertex_at(after(from)), b = vertex_at(before(from)), p = vertex_at(from),
                q = vertex_at(to);
    if (are_neighbors(p, q)) return false;
    old_faces_ = {from >> 2, to >> 2};
    new_triangles_ = {{p, a, q}, {p, q, b}};
    for (const Index vertex : {a, b, q}) bounds.extend(position(vertex));
  } else {
    list_ring(from);
    for (const auto& [corner, left, right] : ring_) {
      old_faces_.push_back(corner >> 2);
      bounds.extend(position(left));
      if (left != to && right != to) new_triangles_.push_back({to, left, right});
    }
  }
  Directions not_faced = 0;
  for (const Corners& triangle : new_triangles_)
    not_faced |= directions_not_faced(points(triangle));
  if ((not_faced | cells_.within(bounds)) == all_directions && do_intersect(bounds)) return false;
  cells_.add(bounds, not_faced);
  if (is_flip) {
    flip(from, to);
  } else {
    collapse(from, to);
  }
  return true;
}

void QualityMesh::collapse(Index from, Index to) {
  for (Index corner = vertices_[from].first_corner, next = none; corner != none; corner = next) {
    next = next_corner(corner);
    Face& face = faces_[corner >> 2];
    if (vertex_at(after(corner)) == to || vertex_at(before(corner)) == to) {
      unlink(after(corner));
      unlink(before(corner));
      face.vertices[0] = none;
    } else {
      face.vertices[corner & 3] = to;
      face.quality = unknown;
      link(corner);
    }
  }
  Vertex& removed = vertices_[from];
  removed.first_corner = none;
  removed.valence = 0;
  removed.is_removed = true;
  ring_center_ = none;
}

// Flips the edge opposite to both corners.
void QualityMesh::flip(Index corner, Index other) {
  const Index from = vertex_at(corner), to = vertex_at(other);
  const Index at_b = before(corner), at_a = before(other);
  ring_center_ = none;
  unlink(at_b);
  unlink(at_a);
  faces_[at_b >> 2].vertices[at_b & 3] = to;
  faces_[at_a >> 2].vertices[at_a & 3] = from;
  link(at_b);
  link(at_a);
  faces_[at_b >> 2].quality = faces_[at_a >> 2].quality = unknown;
}

}  // namespace eses::detail::mesh
