#include "mesh/quality_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace eses::detail::mesh {
namespace {

// Returns the squared sine of an angle in degrees.
double squared_sine(double angle) {
  const double sine = std::sin(angle * std::numbers::pi / 180);
  return sine * sine;
}

// Returns the quality of a triangle, the squared sine of its smallest angle.
float quality_of_shape(const TrianglePoints& t, const Vec3& area) {
  return static_cast<float>(squared_sine_of_smallest_angle(t, area));
}
float quality_of_shape(const TrianglePoints& t) { return quality_of_shape(t, area_vector(t)); }

// Number of planes between a stage and the stage before it. An operation at a plane changes
// triangles with vertices about two planes away.
constexpr std::int32_t stage_planes = 2;
// Number of stages after the collapse of short edges. They improve triangles with an angle below
// `min_angle`, in degrees.
constexpr std::int32_t improving_stages = 2;
constexpr double min_angle = 22;
// Edges below this length are collapsed if possible, in units of the spacing.
constexpr double short_edge = 0.6, max_edge_of_short = 1.75;
// Longest edge of any triangle, in units of the spacing. The edges of the plain mesh have at most
// the length of the diagonal of a cell.
constexpr double max_edge = 2.25;
// Smallest angle, in degrees, that a collapse of a short edge may leave. If there is an edge below
// `tiny_edge`, in units of the spacing, the smallest angle may be halved instead: the crossings
// next to a grid point are collapsed one after the other.
constexpr double min_angle_of_collapse = 0.001, tiny_edge = 1e-4;
// Planes after which vertices are frozen, and the largest distance between the plane at which a
// triangle was added and its vertices.
constexpr std::int32_t freeze_planes = stage_planes * (2 + improving_stages) + 2;
constexpr std::int32_t max_drift = 3;
static_assert(freeze_planes + 2 * max_drift <= FacingCells::kept_planes);
// Planes below the frozen ones whose triangles may be near a triangle that changes.
constexpr std::int32_t kept_planes = 2 * max_drift;
// Smallest scalar product of the normals of a new triangle and of the surface at its corners.
constexpr double min_facing = 0.2;
constexpr std::int32_t max_valence = 12;
// Largest scalar product of the normals of triangles on both sides of an edge that counts as fold.
constexpr double fold = -0.98;
// Scalar product of the normals at two corners of a triangle at a cusp.
constexpr double cusp = 0.5;

}  // namespace

QualityMesh::QualityMesh(const Grid& grid, const GridRegion& region, Sink sink)
    : grid_(grid), region_(region), sink_(std::move(sink)), cells_(grid, region) {}

double QualityMesh::memory_bytes(const GridRegion& region, double plane_crossings,
                                 double more_bytes) {
  constexpr double growth = 2, window = 2 * (freeze_planes + kept_planes + max_drift);
  return FacingCells::memory_bytes(region) +
         growth * window * plane_crossings *
             (sizeof(Vertex) + sizeof(std::uint64_t) + 2 * sizeof(Face) + more_bytes);
}

void QualityMesh::add_vertex(const PlainVertex& vertex) {
  if (planes_.empty() || planes_.back().z != vertex.z)
    planes_.push_back({vertex.z, static_cast<Index>(vertices_.size()), {}});
  auto& rows = planes_.back().rows;
  rows.resize(static_cast<std::size_t>(vertex.y) + 1, static_cast<Index>(vertices_.size()));
  vertices_.push_back({.position = vertex.position,
                       .normal = vertex.normal,
                       .z = vertex.z,
                       .patch = static_cast<std::uint8_t>(vertex.patch)});
  new_numbers_.push_back(0);
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
    face_planes_.push_back({plane_, static_cast<Index>(faces_.size())});
  const auto first = static_cast<Index>(4 * faces_.size());
  Face& face = faces_.emplace_back();
  face.plane = plane_;
  TrianglePoints t;
  for (Index i = 0; i < 3; ++i) {
    face.vertices[i] = static_cast<Index>(triangle[i] - first_number_);
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
    const TrianglePoints t = points(triangle);
    return dot(direction, area_vector(t)) > largest * area_error(t);
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
  const auto index = [&](double coordinate, std::size_t axis, std::int64_t begin, int offset) {
    return static_cast<std::int64_t>(
               std::floor((coordinate - grid_.origin[axis]) / grid_.spacing)) -
           begin + offset;
  };
  const std::int64_t low_z = index(wide_bounds.low.z, 2, 0, -1),
                     high_z = index(wide_bounds.high.z, 2, 0, 1),
                     low_y = index(wide_bounds.low.y, 1, region_.begin[1], -1),
                     high_y = index(wide_bounds.high.y, 1, region_.begin[1], 1);
  // Within a row, the vertices are sorted by x up to a spacing.
  const double low_x = wide_bounds.low.x - grid_.spacing,
               high_x = wide_bounds.high.x + grid_.spacing;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    const Plane& plane = planes_[p];
    if (plane.z < low_z || plane.z > high_z) continue;
    const Index plane_end = end_of(p);
    const auto begin_of = [&](std::int64_t y) {
      const auto row = static_cast<std::size_t>(y);
      return vertices_.begin() + (row < plane.rows.size() ? plane.rows[row] : plane_end);
    };
    for (std::int64_t y = std::max<std::int64_t>(0, low_y); y <= high_y; ++y) {
      const auto end = begin_of(y + 1);
      auto next = std::partition_point(
          begin_of(y), end, [&](const Vertex& vertex) { return vertex.position.x < low_x; });
      for (; next != end && next->position.x <= high_x; ++next) {
        if (next->is_removed || !is_near(*next)) continue;
        for (Index corner = next->first_corner; corner != none; corner = next_corner(corner)) {
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

// Returns the index after the last vertex of a plane of `planes_`.
QualityMesh::Index QualityMesh::end_of(std::size_t plane) const {
  return plane + 1 < planes_.size() ? planes_[plane + 1].first_vertex
                                    : static_cast<Index>(vertices_.size());
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
  for (Index vertex = begin; vertex < end; ++vertex) {
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
  const Index end =
      at + 1 != face_planes_.end() ? (at + 1)->first_face : static_cast<Index>(faces_.size());
  for (Index face = at->first_face; face < end; ++face) {
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
  for (Index vertex = begin; vertex < end; ++vertex) {
    if (vertices_[vertex].is_removed) continue;
    new_numbers_[vertex] = next_number_++;
    sink_.vertex(first_number_ + vertex);
  }
}

// Delivers the triangles that were added at planes up to this one.
void QualityMesh::deliver(std::int32_t plane) {
  delivered_triangles_.clear();
  while (!face_planes_.empty() && face_planes_.front().z <= plane) {
    const Index end =
        face_planes_.size() > 1 ? face_planes_[1].first_face : static_cast<Index>(faces_.size());
    for (; delivered_ < end; ++delivered_) {
      const Face& face = faces_[delivered_];
      if (face.vertices[0] == none) continue;
      count(delivered_);
      const auto [a, b, c] = face.vertices;
      delivered_triangles_.push_back({first_number_ + a, first_number_ + b, first_number_ + c});
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
      if (vertex_at(corner) >= vertices) unlink(corner);
  }
  const auto shift = [](auto& list, Index n) { list.erase(list.begin(), list.begin() + n); };
  shift(vertices_, vertices);
  shift(new_numbers_, vertices);
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
  ring_center_ = none;
}

}  // namespace eses::detail::mesh
