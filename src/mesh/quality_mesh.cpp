// The window of QualityMesh: vertices and triangles enter it, pass the stages and leave it.

#include "mesh/quality_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mesh/quality_rules.hpp"

namespace eses::detail::mesh {

QualityMesh::QualityMesh(const Grid& grid, const GridRegion& region, Sink sink)
    : grid_(grid), region_(region), sink_(std::move(sink)), cells_(grid, region) {}

int QualityMesh::window_planes() { return freeze_planes + kept_planes + max_drift; }

double QualityMesh::memory_bytes(const GridRegion& region, double window_crossings,
                                 double more_bytes) {
  constexpr double delivered = 1.15;  // part of the lists
  return FacingCells::memory_bytes(region) +
         delivered * window_crossings *
             (sizeof(Vertex) + sizeof(std::uint64_t) + 2 * sizeof(Face) + more_bytes);
}

void QualityMesh::add_vertex(const PlainVertex& vertex) {
  if (planes_.empty() || planes_.back().z != vertex.z)
    planes_.push_back({vertex.z, vertices_.end(), {}});
  auto& rows = planes_.back().rows;
  rows.resize(static_cast<std::size_t>(vertex.y) + 1, vertices_.end());
  vertices_.push_back({.position = vertex.position,
                       .normal = vertex.normal,
                       .z = vertex.z,
                       .patch = static_cast<std::uint8_t>(vertex.patch)});
  new_numbers_.push_back(0);
  ++vertex_end_;
}

void QualityMesh::add_triangle(const Triangle& triangle) {
  std::int32_t plane = std::numeric_limits<std::int32_t>::min();
  for (const std::uint64_t number : triangle) plane = std::max(plane, at(number).z);
  if (!has_plane_) {
    plane_ = plane;
    frozen_ = plane - freeze_planes - 1;
    has_plane_ = true;
  }
  if (plane > plane_) advance_to(plane);
  if (face_planes_.empty() || face_planes_.back().z != plane_)
    face_planes_.push_back({plane_, faces_.end()});
  const Index first = 4 * faces_.end();
  Face& face = faces_.push_back({});
  face.plane = plane_;
  TrianglePoints t;
  for (Index i = 0; i < 3; ++i) {
    face.vertices[i] = static_cast<Index>(triangle[i]);
    Vertex& vertex = vertices_[face.vertices[i]];
    t[i] = vertex.position;
    link(first + i, vertex, face);
  }
  cells_.add_small(t, directions_not_faced(t));
}

void QualityMesh::finish() {
  if (has_plane_) advance_to(plane_ + freeze_planes + kept_planes);
}

// Adds a corner to the list of its vertex.
void QualityMesh::link(Index corner, Vertex& vertex, Face& face) {
  face.next[corner & 3] = vertex.first_corner;
  vertex.first_corner = corner;
  ++vertex.valence;
}

void QualityMesh::link(Index corner) {
  link(corner, vertices_[vertex_at(corner)], faces_[corner >> 2]);
}

void QualityMesh::unlink(Index corner) {
  Vertex& vertex = vertices_[vertex_at(corner)];
  --vertex.valence;
  const Index next = next_corner(corner);
  if (vertex.first_corner == corner) {
    vertex.first_corner = next;
    return;
  }
  Index last = vertex.first_corner;
  while (next_corner(last) != corner) last = next_corner(last);
  faces_[last >> 2].next[last & 3] = next;
}

// Returns the squared sine of the smallest angle.
float QualityMesh::quality_of(Index face) {
  Face& f = faces_[face];
  if (f.quality == unknown) f.quality = quality_of_shape(points(f.vertices));
  return f.quality;
}

// Returns the index after the last vertex of a plane of `planes_`.
QualityMesh::Index QualityMesh::end_of(std::size_t plane) const {
  return plane + 1 < planes_.size() ? planes_[plane + 1].first_vertex : vertices_.end();
}

// Returns the range of the vertices of a plane.
std::pair<QualityMesh::Index, QualityMesh::Index> QualityMesh::vertices_of(std::int32_t z) const {
  for (std::size_t p = 0; p < planes_.size(); ++p)
    if (planes_[p].z == z) return {planes_[p].first_vertex, end_of(p)};
  return {0, 0};
}

void QualityMesh::advance_to(std::int32_t plane) {
  while (plane_ < plane) {
    ++plane_;
    std::int32_t at = plane_ - stage_planes;
    limits_.max_squared_length = std::pow(max_edge_of_short * grid_.spacing, 2);
    collapse_short_edges(at);
    limits_.max_squared_length = std::pow(max_edge * grid_.spacing, 2);
    for (std::int32_t stage = 0; stage < improving_stages; ++stage)
      improve_faces(at -= stage_planes);
    freeze(plane_ - freeze_planes);
    deliver(plane_ - freeze_planes - kept_planes);
  }
  drop_delivered();
}

// Collapses vertices of a plane into neighbours that are near.
void QualityMesh::collapse_short_edges(std::int32_t plane) {
  static const auto min_quality = static_cast<float>(squared_sine(min_angle_of_collapse));
  const double max_squared_edge = std::pow(short_edge * grid_.spacing, 2),
               max_squared_tiny_edge = std::pow(tiny_edge * grid_.spacing, 2);
  const auto [begin, end] = vertices_of(plane);
  for (Index vertex = begin; vertex != end; ++vertex) {
    const auto squared_edge = [&](Index other) {
      return squared_norm(position(other) - position(vertex));
    };
    double min_squared_edge = max_squared_edge;
    for (Index corner = vertices_[vertex].first_corner; corner != none;) {
      const Face& face = faces_[corner >> 2];
      const Index i = corner & 3;
      min_squared_edge = std::min(min_squared_edge, squared_edge(face.vertices[i < 2 ? i + 1 : 0]));
      corner = face.next[i];
    }
    if (min_squared_edge == max_squared_edge) continue;
    operations_.clear();
    if (min_squared_edge < max_squared_tiny_edge) {
      list_ring_to_improve(vertex);
      limits_.min_quality /= 4;  // half of the angle, as the quality is a squared sine
    } else {
      list_ring(vertex);
      limits_.min_quality = min_quality;
    }
    for (const RingCorner& at : ring_)
      if (squared_edge(at.left) < max_squared_edge && !has_too_many_neighbors(vertex, at.left))
        consider_collapse(vertex, at.left);
    perform_best();
  }
}

// Improves the triangles that were added at a plane.
void QualityMesh::improve_faces(std::int32_t plane) {
  static const auto min_quality = static_cast<float>(squared_sine(min_angle));
  const auto at = std::find_if(face_planes_.begin(), face_planes_.end(),
                               [&](const FacePlane& p) { return p.z == plane; });
  if (at == face_planes_.end()) return;
  const Index end = at + 1 != face_planes_.end() ? (at + 1)->first_face : faces_.end();
  for (Index face = at->first_face; face != end; ++face) {
    const Corners triangle = faces_[face].vertices;
    if (triangle[0] == none || quality_of(face) >= min_quality) continue;
    operations_.clear();
    std::array<std::pair<double, Index>, 3> edges;  // squared length, corner opposite to the edge
    const TrianglePoints t = points(triangle);
    for (Index i = 0; i < 3; ++i)
      edges[i] = {squared_norm(t[(i + 2) % 3] - t[(i + 1) % 3]), 4 * face + i};
    std::sort(edges.begin(), edges.end());
    consider_flip(edges[2].second);
    consider_collapses(edges[0].second);
    if (perform_best()) continue;
    consider_flip(edges[1].second);
    consider_flip(edges[0].second);
    consider_collapses(edges[1].second);
    consider_collapses(edges[2].second);
    if (perform_best()) continue;
    for (const Index vertex : triangle) consider_all_collapses(vertex);
    perform_best();
  }
}

// Numbers the vertices of a plane.
void QualityMesh::freeze(std::int32_t plane) {
  frozen_ = plane;
  const auto [begin, end] = vertices_of(plane);
  for (Index vertex = begin; vertex != end; ++vertex) {
    if (vertices_[vertex].is_removed) continue;
    new_numbers_[vertex] = next_number_++;
    sink_.vertex(number_of(vertex));
  }
}

// Delivers the triangles that were added at planes up to this one.
void QualityMesh::deliver(std::int32_t plane) {
  delivered_triangles_.clear();
  while (!face_planes_.empty() && face_planes_.front().z <= plane) {
    const Index end = face_planes_.size() > 1 ? face_planes_[1].first_face : faces_.end();
    for (; delivered_ != end; ++delivered_) {
      const Face& face = faces_[delivered_];
      if (face.vertices[0] == none) continue;
      count(delivered_);
      const auto [a, b, c] = face.vertices;
      delivered_triangles_.push_back({number_of(a), number_of(b), number_of(c)});
    }
    face_planes_.pop_front();
  }
  sink_.triangles(delivered_triangles_);
}

// Returns whether normals at two corners of a triangle form an angle of more than 60 degrees.
bool QualityMesh::is_at_cusp(const Corners& triangle) const {
  const auto normal = [&](std::size_t i) { return vertices_[triangle[i]].normal; };
  return std::min({dot(normal(0), normal(1)), dot(normal(1), normal(2)),
                   dot(normal(2), normal(0))}) < cusp;
}

// Returns whether a triangle has a common corner with a triangle at a cusp. Triangles that were
// removed from the window have marked their corners.
bool QualityMesh::is_near_cusp(const Corners& triangle) const {
  for (const Index vertex : triangle) {
    if (vertices_[vertex].is_at_cusp) return true;
    for (Index corner = vertices_[vertex].first_corner; corner != none;
         corner = next_corner(corner))
      if (is_at_cusp(faces_[corner >> 2].vertices)) return true;
  }
  return false;
}

void QualityMesh::count(Index index) {
  static const double below_20 = squared_sine(20), below_5 = squared_sine(5);
  constexpr float rounding = 1 - 1e-6F;
  const Face& face = faces_[index];
  const TrianglePoints t = points(face.vertices);
  double quality = quality_of(index);
  // Rounding of the stored quality must not change the counts.
  if (rounding * quality < std::max(below_20, smallest_quality_))
    quality = squared_sine_of_smallest_angle(t, area_vector(t));
  smallest_quality_ = std::min(smallest_quality_, quality);
  if (is_at_cusp(face.vertices)) {
    ++quality_.at_cusps;
    for (const Index vertex : face.vertices) vertices_[vertex].is_at_cusp = true;
  }
  if (quality < below_20) ++quality_.below_20;
  if (quality < below_5) {
    ++quality_.below_5;
    if (is_near_cusp(face.vertices)) ++quality_.below_5_near_cusps;
  }
}

MeshQuality QualityMesh::quality() const {
  MeshQuality result = quality_;
  result.smallest_angle = std::asin(std::sqrt(smallest_quality_)) * 180 / std::numbers::pi;
  return result;
}

// Removes delivered triangles and their vertices from the window, when there are enough of them.
void QualityMesh::drop_delivered() {
  constexpr Index min_share = 8;
  const Index delivered = delivered_ - faces_.first();
  if (min_share * delivered < faces_.end() - faces_.first()) return;
  // Delivered triangles may only share vertices of these planes with the others.
  const std::int32_t kept = plane_ - freeze_planes - kept_planes - max_drift;
  while (!planes_.empty() && planes_.front().z < kept) planes_.pop_front();
  const Index first_vertex = planes_.empty() ? vertices_.end() : planes_.front().first_vertex;
  // Corners of delivered triangles leave the lists of their vertices.
  const Index kept_vertices = vertices_.end() - first_vertex;
  for (Index face = faces_.first(); face != delivered_; ++face) {
    if (faces_[face].vertices[0] == none) continue;
    for (Index corner = 4 * face; corner != 4 * face + 3; ++corner)
      if (vertices_.end() - vertex_at(corner) <= kept_vertices) unlink(corner);
  }
  vertices_.remove_before(first_vertex);
  new_numbers_.remove_before(first_vertex);
  faces_.remove_before(delivered_);
  ring_center_ = none;
}

}  // namespace eses::detail::mesh
