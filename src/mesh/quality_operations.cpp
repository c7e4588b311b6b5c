// Collapses and flips: which ones are possible, which one is best, and how the mesh changes.

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mesh/quality_mesh.hpp"
#include "mesh/quality_rules.hpp"

namespace eses::detail::mesh {

namespace {

double least_facing(const Vec3& area, const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::min(std::min(dot(area, a), dot(area, b)), dot(area, c));
}

}  // namespace

// Returns the smallest scalar product of the unit normal of a triangle with the normals of the
// surface at its corners.
double QualityMesh::facing(const Vertex& a, const Vertex& b, const Vertex& c) {
  const Vec3 area = area_vector(a.position, b.position, c.position);
  const double length = norm(area);
  if (length == 0) return -1;
  return std::min(length, least_facing(area, a.normal, b.normal, c.normal)) / length;
}

double QualityMesh::facing(const Corners& triangle) const {
  const auto [a, b, c] = triangle;
  return facing(vertices_[a], vertices_[b], vertices_[c]);
}

// Whether all triangles at a vertex are in the window and may change.
bool QualityMesh::can_change(const Vertex& vertex) const {
  return frozen_ < vertex.z && vertex.z < plane_;
}

// Returns whether a vertex is near enough to the plane of a triangle to become its corner.
bool QualityMesh::can_have(const Face& face, const Vertex& vertex) {
  return std::abs(vertex.z - face.plane) <= max_drift;
}

// Returns the corner opposite to the same edge in the other triangle at the edge, or `none`.
QualityMesh::Index QualityMesh::corner_across(Index corner) const {
  const Index from = vertex_at(after(corner)), to = vertex_at(before(corner));
  for (const Index other : vertices_[from].corners())
    if (faces_[other >> 2].before(other) == to) return after(other);
  return none;
}

// Lists the triangles at a vertex, and marks its neighbours. The list is empty if the vertex must
// not be removed, as it is at the border of the mesh.
void QualityMesh::list_ring(Index vertex) {
  if (ring_center_ == vertex) return;
  ring_center_ = vertex;
  ++mark_;
  const auto corners = vertices_[vertex].corners();
  ring_.resize(corners.size());
  Index ends = 0;
  auto at = ring_.rbegin();  // the newest corner is the first one
  for (const Index corner : corners) {
    Face& face = faces_[corner >> 2];
    const Index left = face.after(corner), right = face.before(corner);
    Vertex& at_left = vertices_[left];
    at_left.mark = mark_;
    *at++ = {corner, left, right, &face, &at_left, &vertices_[right]};
    ends ^= left ^ right;
  }
  // The triangles form a fan. If it is closed, each neighbour is on the left and on the right.
  if (ends != 0) ring_.clear();
}

// Lists the ring of a vertex. From now on, new triangles must be better than its worst triangle.
void QualityMesh::list_ring_to_improve(Index vertex) {
  list_ring(vertex);
  limits_.min_quality = 1;
  for (const RingCorner& at : ring_)
    limits_.min_quality = std::min(limits_.min_quality, quality_of(*at.face));
}

// Returns whether a collapse of an edge would give its end too many neighbours.
bool QualityMesh::has_too_many_neighbors(Index from, Index to) const {
  return vertices_[from].valence + vertices_[to].valence - 4 > max_valence;
}

// Considers the collapse of `from`, whose ring is listed.
void QualityMesh::consider_collapse(Index from, Index to) {
  if (ring_.size() < 3 || !can_change(to)) return;
  const Vertex& end = vertices_[to];
  // The lengths reject many candidates, and cost less than the shapes.
  for (const RingCorner& at : ring_)
    if (squared_norm(at.at_left->position - end.position) > limits_.max_squared_length &&
        at.right != to)
      return;
  if (!is_collapsible(to)) return;
  const float min_quality = std::max(limits_.min_quality, best_quality());
  float quality = 1;
  bool is_turned = false;
  for (const RingCorner& at : ring_) {
    if (at.left == to || at.right == to) continue;
    if (!can_have(*at.face, end)) return;
    const Vertex &left = *at.at_left, &right = *at.at_right;
    const Vec3 area = area_vector(end.position, left.position, right.position);
    quality =
        std::min(quality, quality_of_shape(end.position, left.position, right.position, area));
    if (quality <= min_quality) return;
    // Whether `facing` is less than `min_facing`.
    const double least = least_facing(area, end.normal, left.normal, right.normal);
    is_turned =
        is_turned || !(least > 0 && least * least >= min_facing * min_facing * squared_norm(area));
  }
  if (is_turned) {
    double old_facing = 1, new_facing = 1;
    for (const RingCorner& at : ring_) {
      old_facing = std::min(old_facing, facing(at.face->vertices));
      if (at.left != to && at.right != to)
        new_facing = std::min(new_facing, facing(end, *at.at_left, *at.at_right));
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
  const Vertex &a = vertices_[vertex_at(after(corner))], &b = vertices_[vertex_at(before(corner))],
               &from = vertices_[vertex_at(corner)], &to = vertices_[vertex_at(other)];
  const Face &one = faces_[corner >> 2], &two = faces_[other >> 2];
  if (&from == &to || !can_change(a) || !can_change(b) || !can_change(from) || !can_change(to) ||
      !can_have(one, to) || !can_have(two, from))
    return;
  if (from.valence >= max_valence || to.valence >= max_valence ||
      squared_norm(from.position - to.position) > limits_.max_squared_length)
    return;
  const float quality = std::min(quality_of_shape(from.position, a.position, to.position),
                                 quality_of_shape(from.position, to.position, b.position));
  if (quality <= std::min(quality_of(corner >> 2), quality_of(other >> 2)) ||
      quality <= best_quality())
    return;
  const double new_facing = std::min(facing(from, a, to), facing(from, to, b));
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
  std::size_t on_left = 0, on_right = 0;  // the triangles at the edge
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    on_left = ring_[i].left == to ? i : on_left;
    on_right = ring_[i].right == to ? i : on_right;
  }
  const Vertex *one = ring_[on_left].at_right, *other = ring_[on_right].at_left;
  if (one->valence < 4 || other->valence < 4) return false;
  const auto corners = vertices_[to].corners();
  int common = 0;
  Index ends = 0;
  for (const Index corner : corners) {
    const Face& face = faces_[corner >> 2];
    const Index left = face.after(corner), right = face.before(corner);
    common += vertices_[left].mark == mark_ ? 1 : 0;
    ends ^= left ^ right;
  }
  // Each neighbour is on the left of one triangle, except at the border of the mesh.
  if (ends == 0) return common == 2;
  const auto is_other_common = [&](Index vertex) {
    const Vertex& at = vertices_[vertex];
    return at.mark == mark_ && &at != one && &at != other;
  };
  return std::ranges::none_of(corners, [&](Index corner) {
    const Face& face = faces_[corner >> 2];
    return is_other_common(face.after(corner)) || is_other_common(face.before(corner));
  });
}

// Returns whether an edge connects two vertices.
bool QualityMesh::are_neighbors(Index one, Index other) const {
  for (const Index corner : vertices_[one].corners()) {
    const Face& face = faces_[corner >> 2];
    if (face.after(corner) == other || face.before(corner) == other) return true;
  }
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
    for (const RingCorner& at : ring_) {
      old_faces_.push_back(at.corner >> 2);
      bounds.extend(at.at_left->position);
      if (at.left != to && at.right != to) new_triangles_.push_back({to, at.left, at.right});
    }
  }
  Directions not_faced = 0;
  for (const auto& [a, b, c] : new_triangles_)
    not_faced |= directions_not_faced(position(a), position(b), position(c));
  if ((not_faced | cells_.within(bounds)) == all_directions && do_intersect(bounds)) return false;
  cells_.add(bounds, not_faced);
  if (is_flip) {
    flip(from, to);
  } else {
    collapse(from, to);
  }
  return true;
}

// Collapses an edge at `from`, whose ring is listed.
void QualityMesh::collapse(Index from, Index to) {
  Vertex& end = vertices_[to];
  for (const RingCorner& at : ring_) {
    if (at.left == to || at.right == to) {
      unlink(after(at.corner));
      unlink(before(at.corner));
      at.face->vertices[0] = none;
    } else {
      at.face->vertices[at.corner & 3] = to;
      at.face->quality = unknown;
      link(at.corner, end);
    }
  }
  Vertex& removed = vertices_[from];
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
