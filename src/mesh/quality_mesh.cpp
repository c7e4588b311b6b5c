#include "mesh/quality_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace eses::detail::mesh {
namespace {

// Squared sine of an angle in degrees.
double quality_of(double angle) {
  const double sine = std::sin(angle * std::numbers::pi / 180);
  return sine * sine;
}

// Number of planes between a stage and the stage before it. An operation at a plane changes
// triangles with vertices about two planes away.
constexpr std::int32_t stage_planes = 2;
// The stages after the collapse of short edges: triangles with a smaller angle are improved.
struct Stage {
  double min_angle;  // degrees
  double max_edge;   // longest new edge, in units of the spacing
};
constexpr std::array<Stage, 3> stages{{{30, 1.75}, {22, 2.25}, {22, 2.25}}};
// Edges below this length are collapsed if possible, in units of the spacing.
constexpr double short_edge = 0.5, max_edge_of_short = 1.75;
// Longest edge of any triangle, in units of the spacing. The edges of the plain mesh have at most
// the length of the diagonal of a cell.
constexpr double max_edge = 2.25;
// Smallest angle, in degrees, that a collapse of a short edge may leave.
constexpr double min_angle_of_collapse = 0.001;
// Planes after which vertices are frozen, and the largest distance between the plane at which a
// triangle was added and its vertices.
constexpr std::int32_t freeze_planes =
    stage_planes * (2 + static_cast<std::int32_t>(stages.size())) + 2;
constexpr std::int32_t max_drift = 3;
// Planes below the frozen ones whose triangles may be near a triangle that changes.
constexpr std::int32_t kept_planes = 2 * max_drift;
// Smallest scalar product of the normals of a new triangle and of the surface at its corners.
constexpr double min_facing = 0.2;
constexpr std::int32_t max_valence = 12;
// Largest scalar product of the normals of triangles on both sides of an edge that counts as fold.
constexpr double fold = -0.98;
// Scalar product of the normals at two corners of a triangle at a cusp.
constexpr double cusp = 0.5;

bool is_beyond(double a, double b, double c, double limit) {
  return a > limit && b > limit && c > limit;
}

}  // namespace

QualityMesh::QualityMesh(double spacing, Sink sink) : spacing_(spacing), sink_(std::move(sink)) {
  quality_.smallest_angle = 90;
}

double QualityMesh::memory_bytes(double plane_crossings, double more_bytes) {
  constexpr double growth = 2, window = 2 * (freeze_planes + kept_planes + max_drift);
  return growth * window * plane_crossings * (sizeof(Vertex) + 2 * sizeof(Face) + more_bytes);
}

void QualityMesh::add_vertex(const PlainVertex& vertex) {
  if (planes_.empty() || planes_.back().z != vertex.z)
    planes_.push_back({vertex.z, static_cast<Index>(vertices_.size()), {}});
  auto& rows = planes_.back().rows;
  rows.resize(static_cast<std::size_t>(vertex.y) + 1, static_cast<Index>(vertices_.size()));
  vertices_.push_back({.plain = vertex});
}

void QualityMesh::add_triangle(const Triangle& triangle) {
  Face face;
  std::int32_t plane = std::numeric_limits<std::int32_t>::min();
  for (std::size_t i = 0; i < triangle.size(); ++i) {
    face.vertices[i] = static_cast<Index>(triangle[i] - first_number_);
    plane = std::max(plane, vertices_[face.vertices[i]].plain.z);
  }
  if (!has_plane_) {
    plane_ = plane;
    frozen_ = plane - freeze_planes - 1;
    has_plane_ = true;
  }
  if (plane > plane_) {
    advance_to(plane);
    for (std::size_t i = 0; i < triangle.size(); ++i)
      face.vertices[i] = static_cast<Index>(triangle[i] - first_number_);
  }
  face.plane = plane_;
  if (face_planes_.empty() || face_planes_.back().z != plane_)
    face_planes_.push_back({plane_, static_cast<Index>(faces_.size())});
  const auto first = static_cast<Index>(4 * faces_.size());
  faces_.push_back(face);
  for (Index corner = first; corner < first + 3; ++corner) link(corner);
}

void QualityMesh::finish() {
  if (has_plane_) advance_to(plane_ + freeze_planes + kept_planes);
}

void QualityMesh::link(Index corner) {
  Vertex& vertex = vertices_[corner_vertex(corner, 0)];
  faces_[corner >> 2].next[corner & 3] = vertex.first_corner;
  vertex.first_corner = corner;
  ++vertex.valence;
}

void QualityMesh::unlink(Index corner) {
  Vertex& vertex = vertices_[corner_vertex(corner, 0)];
  --vertex.valence;
  const Index next = next_corner(corner);
  if (vertex.first_corner == corner) {
    vertex.first_corner = next;
    return;
  }
  Index before = vertex.first_corner;
  while (next_corner(before) != corner) before = next_corner(before);
  faces_[before >> 2].next[before & 3] = next;
}

// Returns the smallest scalar product of the unit normal of a triangle with the normals of the
// surface at its corners.
double QualityMesh::facing(const std::array<Index, 3>& triangle) const {
  const Vec3 area = area_vector(points(triangle));
  const double length = norm(area);
  if (length == 0) return -1;
  double least = length;
  for (const Index vertex : triangle)
    least = std::min(least, dot(area, vertices_[vertex].plain.normal));
  return least / length;
}

// Whether all triangles at a vertex are in the window and may change.
bool QualityMesh::can_change(Index vertex) const {
  const std::int32_t z = vertices_[vertex].plain.z;
  return frozen_ < z && z < plane_;
}

bool QualityMesh::can_have(const Face& face, Index vertex) const {
  return std::abs(vertices_[vertex].plain.z - face.plane) <= max_drift;
}

// Returns the corner opposite to the same edge in the other triangle at the edge, or `none`.
QualityMesh::Index QualityMesh::corner_across(Index corner) const {
  const Index from = corner_vertex(corner, 1), to = corner_vertex(corner, 2);
  for (Index other = vertices_[from].first_corner; other != none; other = next_corner(other))
    if (corner_vertex(other, 2) == to) return (other & ~Index{3}) | ((other & 3) + 1) % 3;
  return none;
}

// Marks the neighbours of a vertex, and lists its corners. The list is empty if the vertex must not
// be removed, as it is at the border of the mesh.
void QualityMesh::mark_ring(Index vertex) {
  ++mark_;
  ring_corners_.clear();
  for (Index corner = vertices_[vertex].first_corner; corner != none;
       corner = next_corner(corner)) {
    ring_corners_.push_back(corner);
    vertices_[corner_vertex(corner, 1)].mark = mark_;
  }
  for (const Index corner : ring_corners_)
    if (vertices_[corner_vertex(corner, 2)].mark != mark_) {
      ring_corners_.clear();
      return;
    }
}

// Considers the collapse of `from`, whose ring is marked.
void QualityMesh::consider_collapse(Index from, Index to) {
  if (ring_corners_.size() < 3 || !can_change(to)) return;
  if (vertices_[from].valence + vertices_[to].valence - 4 > max_valence) return;
  // The two vertices opposite to the edge are the only common neighbours.
  std::array<Index, 2> opposite{none, none};
  double old_facing = 1;
  for (const Index corner : ring_corners_) {
    if (corner_vertex(corner, 1) == to) opposite[0] = corner_vertex(corner, 2);
    if (corner_vertex(corner, 2) == to) opposite[1] = corner_vertex(corner, 1);
  }
  for (const Index vertex : opposite)
    if (vertex == none || vertices_[vertex].valence < 4) return;
  for (Index corner = vertices_[to].first_corner; corner != none; corner = next_corner(corner))
    for (const Index step : {1U, 2U}) {
      const Index vertex = corner_vertex(corner, step);
      if (vertices_[vertex].mark == mark_ && vertex != opposite[0] && vertex != opposite[1]) return;
    }
  double quality = 1;
  for (const Index corner : ring_corners_) {
    const Index a = corner_vertex(corner, 1), b = corner_vertex(corner, 2);
    if (a == to || b == to) continue;
    if (squared_norm(position(a) - position(to)) > limits_.max_squared_length ||
        !can_have(faces_[corner >> 2], to))
      return;
    quality = std::min(quality, squared_sine_of_smallest_angle(points({to, a, b})));
    if (quality <= limits_.min_quality) return;
  }
  for (const Index corner : ring_corners_)
    old_facing = std::min(old_facing, facing(faces_[corner >> 2].vertices));
  const double least = std::min(old_facing, min_facing);
  for (const Index corner : ring_corners_) {
    const Index a = corner_vertex(corner, 1), b = corner_vertex(corner, 2);
    if (a != to && b != to && facing({to, a, b}) < least) return;
  }
  operations_.push_back({quality, false, from, to});
}

// Considers the flip of the edge opposite to a corner.
void QualityMesh::consider_flip(Index corner) {
  const Index other = corner_across(corner);
  if (other == none) return;
  const Index a = corner_vertex(corner, 1), b = corner_vertex(corner, 2),
              from = corner_vertex(corner, 0), to = corner_vertex(other, 0);
  const Face &one = faces_[corner >> 2], &two = faces_[other >> 2];
  if (from == to || !can_change(a) || !can_change(b) || !can_change(from) || !can_change(to) ||
      !can_have(one, to) || !can_have(two, from))
    return;
  if (vertices_[from].valence >= max_valence || vertices_[to].valence >= max_valence ||
      squared_norm(position(from) - position(to)) > limits_.max_squared_length)
    return;
  const std::array<Index, 3> left{from, a, to}, right{from, to, b};
  const double old_quality = std::min(squared_sine_of_smallest_angle(points(one.vertices)),
                                      squared_sine_of_smallest_angle(points(two.vertices)));
  const double quality = std::min(squared_sine_of_smallest_angle(points(left)),
                                  squared_sine_of_smallest_angle(points(right)));
  if (quality <= old_quality) return;
  if (std::min(facing(left), facing(right)) <
      std::min({facing(one.vertices), facing(two.vertices), min_facing}))
    return;
  for (Index at = vertices_[from].first_corner; at != none; at = next_corner(at))
    if (corner_vertex(at, 1) == to || corner_vertex(at, 2) == to) return;
  operations_.push_back({quality, true, corner, other});
}

// Performs the best operation that causes no intersection. Returns false if there is none.
bool QualityMesh::perform_best() {
  std::stable_sort(operations_.begin(), operations_.end(),
                   [](const Operation& a, const Operation& b) { return a.quality > b.quality; });
  for (const auto& [quality, is_flip, from, to] : operations_) {
    old_faces_.clear();
    new_triangles_.clear();
    if (is_flip) {
      const Index a = corner_vertex(from, 1), b = corner_vertex(from, 2),
                  p = corner_vertex(from, 0), q = corner_vertex(to, 0);
      old_faces_ = {from >> 2, to >> 2};
      new_triangles_ = {{p, a, q}, {p, q, b}};
    } else {
      for (Index corner = vertices_[from].first_corner; corner != none;
           corner = next_corner(corner)) {
        old_faces_.push_back(corner >> 2);
        const Index a = corner_vertex(corner, 1), b = corner_vertex(corner, 2);
        if (a != to && b != to) new_triangles_.push_back({to, a, b});
      }
    }
    if (!is_free(old_faces_, new_triangles_)) continue;
    if (is_flip) {
      flip(from, to);
    } else {
      collapse(from, to);
    }
    return true;
  }
  return false;
}

void QualityMesh::collapse(Index from, Index to) {
  for (Index corner = vertices_[from].first_corner, next = none; corner != none; corner = next) {
    next = next_corner(corner);
    Face& face = faces_[corner >> 2];
    if (corner_vertex(corner, 1) == to || corner_vertex(corner, 2) == to) {
      for (const Index step : {1U, 2U}) unlink((corner & ~Index{3}) | ((corner & 3) + step) % 3);
      face.vertices[0] = none;
    } else {
      face.vertices[corner & 3] = to;
      link(corner);
    }
  }
  Vertex& removed = vertices_[from];
  removed.first_corner = none;
  removed.valence = 0;
  removed.is_removed = true;
}

// Flips the edge opposite to both corners.
void QualityMesh::flip(Index corner, Index other) {
  const Index from = corner_vertex(corner, 0), to = corner_vertex(other, 0);
  const Index one = corner & ~Index{3}, two = other & ~Index{3};
  const Index at_b = one | ((corner & 3) + 2) % 3, at_a = two | ((other & 3) + 2) % 3;
  unlink(at_b);
  unlink(at_a);
  faces_[at_b >> 2].vertices[at_b & 3] = to;
  faces_[at_a >> 2].vertices[at_a & 3] = from;
  link(at_b);
  link(at_a);
}

// Returns whether new triangles that replace old ones intersect no other triangle.
//
// If all triangles near them face into one half space of directions, the surface near them has a
// single sheet, which is a graph over a plane; two sheets of a closed surface that face in the same
// direction have a third one between them that faces in the opposite direction. New triangles that
// face in this direction, too, are then part of a graph. Otherwise all pairs are compared.
bool QualityMesh::is_free(std::span<const Index> old_faces,
                          std::span<const std::array<Index, 3>> triangles) {
  constexpr double far = std::numeric_limits<double>::max();
  Bounds bounds{{far, far, far}, {-far, -far, -far}};
  Vec3 direction;
  bool is_graph = true;
  for (const Index face : old_faces)
    for (const Index vertex : faces_[face].vertices)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        bounds.low[axis] = std::min(bounds.low[axis], position(vertex)[axis]);
        bounds.high[axis] = std::max(bounds.high[axis], position(vertex)[axis]);
      }
  for (const auto& triangle : triangles) direction = direction + area_vector(points(triangle));
  for (const auto& triangle : triangles)
    is_graph = is_graph && dot(direction, area_vector(points(triangle))) > 0;
  if (gather(bounds, direction, old_faces) && is_graph) return true;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (intersect(triangles[i], triangles[j])) return false;
    for (const Index face : near_faces_)
      if (intersect(triangles[i], faces_[face].vertices)) return false;
  }
  return true;
}

// Lists the triangles within bounds, except `old_faces`. Returns whether all triangles within
// bounds, including the old ones, face in a direction.
bool QualityMesh::gather(const Bounds& bounds, const Vec3& direction,
                         std::span<const Index> old_faces) {
  near_faces_.clear();
  ++face_mark_;
  bool all_face = true;
  for (const Index face : old_faces) {
    faces_[face].mark = face_mark_;
    all_face = all_face && dot(direction, area_vector(points(faces_[face].vertices))) > 0;
  }
  // The points of a triangle are at most 1 / sqrt(3) of its longest edge from a corner.
  const double reach = max_edge * spacing_ / std::numbers::sqrt3;
  const Vec3 margin{reach, reach, reach};
  const Bounds wide{bounds.low - margin, bounds.high + margin};
  std::int32_t low_y = std::numeric_limits<std::int32_t>::max(), high_y = 0;
  std::int32_t low_z = low_y, high_z = std::numeric_limits<std::int32_t>::min();
  for (const Index face : old_faces)
    for (const Index vertex : faces_[face].vertices) {
      const PlainVertex& plain = vertices_[vertex].plain;
      low_y = std::min(low_y, plain.y);
      high_y = std::max(high_y, plain.y);
      low_z = std::min(low_z, plain.z);
      high_z = std::max(high_z, plain.z);
    }
  // A vertex of row y is at a coordinate in [y, y + 1).
  constexpr std::int32_t rows = 2;
  static_assert(max_edge < rows * std::numbers::sqrt3);
  low_y = std::max(0, low_y - rows);
  const auto is_apart = [](const Vec3& low, const Vec3& high, const Bounds& box) {
    return low.x > box.high.x || low.y > box.high.y || low.z > box.high.z || high.x < box.low.x ||
           high.y < box.low.y || high.z < box.low.z;
  };
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    const Plane& plane = planes_[p];
    if (plane.z < low_z - rows || plane.z > high_z + rows) continue;
    const Index plane_end =
        p + 1 < planes_.size() ? planes_[p + 1].first_vertex : static_cast<Index>(vertices_.size());
    const auto begin_of = [&](std::int32_t y) {
      const auto row = static_cast<std::size_t>(y);
      return row < plane.rows.size() ? plane.rows[row] : plane_end;
    };
    for (std::int32_t y = low_y; y <= high_y + rows; ++y) {
      const auto begin = vertices_.begin() + begin_of(y), end = vertices_.begin() + begin_of(y + 1);
      // Within a row, the vertices are sorted by x up to a spacing.
      auto next =
          end - begin < 8 ? begin : std::partition_point(begin, end, [&](const Vertex& vertex) {
            return vertex.plain.position.x < wide.low.x - spacing_;
          });
      for (; next != end && next->plain.position.x <= wide.high.x + spacing_; ++next) {
        const Vec3& at = next->plain.position;
        if (next->is_removed || is_apart(at, at, wide)) continue;
        for (Index corner = next->first_corner; corner != none; corner = next_corner(corner)) {
          Face& face = faces_[corner >> 2];
          if (face.mark == face_mark_) continue;
          face.mark = face_mark_;
          const TrianglePoints t = points(face.vertices);
          Vec3 low = t[0], high = t[0];
          for (const Vec3& point : {t[1], t[2]})
            for (std::size_t axis = 0; axis < 3; ++axis) {
              low[axis] = std::min(low[axis], point[axis]);
              high[axis] = std::max(high[axis], point[axis]);
            }
          if (is_apart(low, high, bounds)) continue;
          near_faces_.push_back(corner >> 2);
          all_face = all_face && dot(direction, area_vector(t)) > 0;
        }
      }
    }
  }
  return all_face;
}

// Returns whether two triangles have common points besides common corners and edges.
bool QualityMesh::intersect(const std::array<Index, 3>& one,
                            const std::array<Index, 3>& other) const {
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
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double limit = std::max({b[0][axis], b[1][axis], b[2][axis]});
    if (is_beyond(a[0][axis], a[1][axis], a[2][axis], limit)) return false;
    const double other_limit = std::max({a[0][axis], a[1][axis], a[2][axis]});
    if (is_beyond(b[0][axis], b[1][axis], b[2][axis], other_limit)) return false;
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

void QualityMesh::advance_to(std::int32_t plane) {
  while (plane_ < plane) {
    ++plane_;
    std::int32_t at = plane_ - stage_planes;
    limits_ = {max_edge_of_short * max_edge_of_short * spacing_ * spacing_,
               quality_of(min_angle_of_collapse)};
    collapse_short_edges(at);
    for (const Stage& stage : stages) {
      at -= stage_planes;
      limits_.max_squared_length = stage.max_edge * stage.max_edge * spacing_ * spacing_;
      improve_faces(at, quality_of(stage.min_angle));
    }
    freeze(plane_ - freeze_planes);
    deliver(plane_ - freeze_planes - kept_planes);
  }
  drop_delivered();
}

// Considers the collapses of the edges at a vertex that are not too long, in both directions.
void QualityMesh::consider_collapses(Index vertex, double max_squared_edge) {
  mark_ring(vertex);
  std::array<Index, 32> others;
  std::size_t count = 0;
  for (Index corner = vertices_[vertex].first_corner; corner != none;
       corner = next_corner(corner)) {
    const Index other = corner_vertex(corner, 1);
    if (squared_norm(position(other) - position(vertex)) < max_squared_edge &&
        count < others.size())
      others[count++] = other;
  }
  for (std::size_t i = 0; i < count; ++i) consider_collapse(vertex, others[i]);
  for (std::size_t i = 0; i < count; ++i) {
    if (!can_change(others[i])) continue;
    mark_ring(others[i]);
    consider_collapse(others[i], vertex);
  }
}

void QualityMesh::collapse_short_edges(std::int32_t plane) {
  constexpr int max_collapses = 4;
  const double max_squared_edge = short_edge * short_edge * spacing_ * spacing_;
  const auto at =
      std::find_if(planes_.begin(), planes_.end(), [&](const Plane& p) { return p.z == plane; });
  if (at == planes_.end()) return;
  const Index end =
      at + 1 != planes_.end() ? (at + 1)->first_vertex : static_cast<Index>(vertices_.size());
  for (Index vertex = at->first_vertex; vertex < end; ++vertex)
    for (int i = 0; i < max_collapses && !vertices_[vertex].is_removed; ++i) {
      operations_.clear();
      consider_collapses(vertex, max_squared_edge);
      if (!perform_best()) break;
    }
}

void QualityMesh::improve_faces(std::int32_t plane, double min_angle_quality) {
  const auto at = std::find_if(face_planes_.begin(), face_planes_.end(),
                               [&](const FacePlane& p) { return p.z == plane; });
  if (at == face_planes_.end()) return;
  const Index end =
      at + 1 != face_planes_.end() ? (at + 1)->first_face : static_cast<Index>(faces_.size());
  for (Index face = at->first_face; face < end; ++face) {
    const std::array<Index, 3> triangle = faces_[face].vertices;
    if (triangle[0] == none) continue;
    if (squared_sine_of_smallest_angle(points(triangle)) >= min_angle_quality) continue;
    operations_.clear();
    for (const Index from : triangle) {
      if (!can_change(from)) continue;
      mark_ring(from);
      double old_quality = 1;
      for (const Index corner : ring_corners_)
        old_quality = std::min(
            old_quality, squared_sine_of_smallest_angle(points(faces_[corner >> 2].vertices)));
      limits_.min_quality = old_quality;
      for (const Index to : triangle)
        if (to != from) consider_collapse(from, to);
    }
    for (Index corner = 4 * face; corner < 4 * face + 3; ++corner) consider_flip(corner);
    perform_best();
  }
}

// Numbers the vertices of a plane.
void QualityMesh::freeze(std::int32_t plane) {
  frozen_ = plane;
  const auto at =
      std::find_if(planes_.begin(), planes_.end(), [&](const Plane& p) { return p.z == plane; });
  if (at == planes_.end()) return;
  const Index end =
      at + 1 != planes_.end() ? (at + 1)->first_vertex : static_cast<Index>(vertices_.size());
  for (Index vertex = at->first_vertex; vertex < end; ++vertex) {
    if (vertices_[vertex].is_removed) continue;
    vertices_[vertex].new_number = next_number_++;
    sink_.vertex(first_number_ + vertex);
  }
}

// Delivers the triangles that were added at planes up to this one.
void QualityMesh::deliver(std::int32_t plane) {
  while (!face_planes_.empty() && face_planes_.front().z <= plane) {
    const Index end =
        face_planes_.size() > 1 ? face_planes_[1].first_face : static_cast<Index>(faces_.size());
    for (; delivered_ < end; ++delivered_) {
      const Face& face = faces_[delivered_];
      if (face.vertices[0] == none) continue;
      count(face);
      Triangle triangle{};
      for (std::size_t i = 0; i < 3; ++i) triangle[i] = first_number_ + face.vertices[i];
      sink_.triangle(triangle);
    }
    face_planes_.pop_front();
  }
}

void QualityMesh::count(const Face& face) {
  const double quality = squared_sine_of_smallest_angle(points(face.vertices));
  const double angle = std::asin(std::sqrt(std::min(1.0, quality))) * 180 / std::numbers::pi;
  const auto normal = [&](std::size_t i) { return vertices_[face.vertices[i]].plain.normal; };
  const bool is_at_cusp = std::min({dot(normal(0), normal(1)), dot(normal(1), normal(2)),
                                    dot(normal(2), normal(0))}) < cusp;
  quality_.smallest_angle = std::min(quality_.smallest_angle, angle);
  if (angle < 20) ++quality_.below_20;
  if (angle < 5) ++quality_.below_5;
  if (is_at_cusp) ++quality_.at_cusps;
  if (is_at_cusp && angle < 5) ++quality_.below_5_at_cusps;
}

// Removes delivered triangles and their vertices from the window, when they are more than half of
// it.
void QualityMesh::drop_delivered() {
  if (2 * std::size_t{delivered_} < faces_.size()) return;
  // Delivered triangles may only share vertices of these planes with the others.
  const std::int32_t kept = plane_ - freeze_planes - kept_planes - max_drift;
  Index vertices = 0;
  while (!planes_.empty() && planes_.front().z < kept) {
    planes_.pop_front();
    vertices =
        planes_.empty() ? static_cast<Index>(vertices_.size()) : planes_.front().first_vertex;
  }
  // Corners of delivered triangles leave the lists of their vertices.
  for (Index face = 0; face < delivered_; ++face) {
    if (faces_[face].vertices[0] == none) continue;
    for (Index corner = 4 * face; corner < 4 * face + 3; ++corner)
      if (corner_vertex(corner, 0) >= vertices) unlink(corner);
  }
  const auto shift = [](auto& list, Index n) { list.erase(list.begin(), list.begin() + n); };
  shift(vertices_, vertices);
  shift(faces_, delivered_);
  first_number_ += vertices;
  for (Face& face : faces_) {
    if (face.vertices[0] == none) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      face.vertices[i] -= vertices;
      if (face.next[i] != none) face.next[i] -= 4 * delivered_;
    }
  }
  for (Vertex& vertex : vertices_)
    if (vertex.first_corner != none) vertex.first_corner -= 4 * delivered_;
  for (Plane& plane : planes_) {
    plane.first_vertex -= vertices;
    for (Index& row : plane.rows) row -= vertices;
  }
  for (FacePlane& plane : face_planes_) plane.first_face -= delivered_;
  delivered_ = 0;
}

}  // namespace eses::detail::mesh
