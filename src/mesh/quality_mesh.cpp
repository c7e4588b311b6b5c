// The window of QualityMesh: vertices and triangles enter it, pass the stages and leave it.

#include "mesh/quality_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/quality_rules.hpp"

namespace eses::detail::mesh {

QualityMesh::QualityMesh(const Grid& grid, const GridRegion& region, Sink sink)
    : grid_(grid), region_(region), sink_(std::move(sink)), cells_(grid, region) {}

int QualityMesh::window_planes() { return freeze_planes + kept_planes + max_drift; }

double QualityMesh::memory_bytes(const GridRegion& region, double window_crossings,
                                 double more_bytes) {
  constexpr double delivered = 1.1;  // part of the lists
  return FacingCells::memory_bytes(region) +
         delivered * window_crossings *
             (sizeof(Vertex) + sizeof(std::uint64_t) + 2 * sizeof(Face) + more_bytes);
}

void QualityMesh::add_vertex(const PlainVertex& vertex) {
  if (planes_.empty() || planes_.back().z != vertex.z)
    planes_.push_back({vertex.z, vertices_.end(), {}});
  auto& rows = planes_.back().rows;
  const auto row_count = static_cast<std::size_t>(vertex.y) + 1;
  if (rows.size() != row_count) rows.resize(row_count, vertices_.end());
  vertices_.push_back({.position = vertex.position,
                       .z = vertex.z,
                       .patch = static_cast<std::uint8_t>(vertex.patch),
                       .normal = vertex.normal});
  new_numbers_.push_back(0);
  ++vertex_end_;
}

void QualityMesh::add_triangle(const Triangle& triangle) {
  std::array<Vertex*, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = &vertices_[static_cast<Index>(triangle[i])];
  const auto& [a, b, c] = corners;
  const std::int32_t plane = std::max(std::max(a->z, b->z), c->z);
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
  for (Index i = 0; i < 3; ++i) {
    face.vertices[i] = static_cast<Index>(triangle[i]);
    link(first + i, *corners[i]);
  }
  cells_.add_small(a->position, b->position, c->position);
}

void QualityMesh::finish() {
  if (has_plane_) advance_to(plane_ + freeze_planes + kept_planes);
}

// Adds a corner to the list of its vertex.
void QualityMesh::link(Index corner, Vertex& vertex) {
  vertex.corner_array[vertex.valence++] = corner;
}

// Removes a corner from the list of its vertex. The loop has no branch, because it would often be
// predicted wrongly.
void QualityMesh::unlink(Index corner) {
  Vertex& vertex = vertices_[vertex_at(corner)];
  std::size_t kept = 0;
  for (const Index other : vertex.corners()) {
    vertex.corner_array[kept] = other;
    kept += other != corner ? 1 : 0;
  }
  vertex.valence = static_cast<std::uint8_t>(kept);
}

float QualityMesh::computed_quality(const Face& face) const {
  const auto [a, b, c] = face.vertices;
  return quality_of_shape(position(a), position(b), position(c));
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
    const Vec3 from = position(vertex);
    const auto squared_edge = [&](const RingCorner& at) {
      return squared_norm(at.at_left->position - from);
    };
    list_ring(vertex);
    double min_squared_edge = max_squared_edge;
    for (const RingCorner& at : ring_)
      min_squared_edge = std::min(min_squared_edge, squared_edge(at));
    if (min_squared_edge == max_squared_edge) continue;
    operations_.clear();
    if (min_squared_edge < max_squared_tiny_edge) {
      list_ring_to_improve(vertex);
      limits_.min_quality /= 4;  // half of the angle, as the quality is a squared sine
    } else {
      limits_.min_quality = min_quality;
    }
    for (const RingCorner& at : ring_)
      if (squared_edge(at) < max_squared_edge && !has_too_many_neighbors(vertex, at.left))
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
    for (const Index corner : vertices_[vertex].corners())
      if (is_in_window(corner) && is_at_cusp(faces_[corner >> 2].vertices)) return true;
  }
  return false;
}

void QualityMesh::count(Index index) {
  static const double below_20 = squared_sine(20), below_5 = squared_sine(5);
  constexpr float rounding = 1 - 1e-6F;
  const Face& face = faces_[index];
  double quality = quality_of(index);
  // Rounding of the stored quality must not change the counts.
  if (rounding * quality < std::max(below_20, smallest_quality_)) {
    const auto [a, b, c] = points(face.vertices);
    quality = squared_sine_of_smallest_angle(a, b, c, area_vector(a, b, c));
  }
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

// Removes delivered triangles and their vertices from the window. The lists of vertices keep the
// corners of these triangles, see `is_in_window`.
void QualityMesh::drop_delivered() {
  // Delivered triangles may only share vertices of these planes with the others.
  const std::int32_t kept = plane_ - freeze_planes - kept_planes - max_drift;
  while (!planes_.empty() && planes_.front().z < kept) planes_.pop_front();
  const Index first_vertex = planes_.empty() ? vertices_.end() : planes_.front().first_vertex;
  vertices_.remove_before(first_vertex);
  new_numbers_.remove_before(first_vertex);
  faces_.remove_before(delivered_);
  ring_center_ = none;
}

}  // namespace eses::detail::mesh
