#pragma once
/// Improvement of the triangles of a mesh in a window that slides along z.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "eses/grid.hpp"
#include "eses/summary.hpp"
#include "eses/vec3.hpp"
#include "mesh/case_table.hpp"
#include "mesh/facing_cells.hpp"
#include "mesh/sliding_list.hpp"
#include "mesh/triangle_shape.hpp"
#include "mesh/triangulate.hpp"

namespace eses::detail::mesh {

/// A vertex of the plain mesh: the crossing of a grid edge.
struct PlainVertex {
  Vec3 position;           ///< angstrom
  Vec3 normal;             ///< outward unit normal
  std::int32_t y = 0;      ///< row of the lower end of the edge, >= 0
  std::int32_t z = 0;      ///< plane of the lower end of the edge
  std::int32_t patch = 1;  ///< 1 convex, 2 saddle, 3 concave
};

/// Makes triangles without small angles from the triangles of marching cubes.
///
/// Two operations change the mesh. A collapse moves a vertex along an edge to the other end of the
/// edge, and so removes the vertex and the two triangles at the edge. A flip replaces the two
/// triangles at an edge by the two triangles at the other diagonal. No vertex is moved to a new
/// position, so that all vertices stay crossings. An operation is performed only if the mesh stays
/// a manifold with the same topology, if no new triangle is turned away from the normals of its
/// corners, and if no new triangle intersects another triangle (see `perform`). Vertices at the
/// border of an open mesh are never removed.
///
/// Planes are processed in ascending order. The triangles at a plane pass through several stages,
/// each one a few planes behind the stage before it, so that a stage sees only finished results of
/// the stage before. No operation depends on anything but the sequence of the triangles.
///
/// A related method with general collapses: M. Botsch, L. Kobbelt, "A remeshing approach to
/// multiresolution modeling", Proc. Symp. Geometry Processing (2004), 185-192.
class QualityMesh {
 public:
  /// The receivers of the result. Vertices are identified by their numbers in the plain mesh.
  struct Sink {
    std::function<void(std::uint64_t vertex)> vertex;  ///< called in ascending order
    /// Called for the triangles of a plane, after the calls of `vertex` for their corners.
    std::function<void(std::span<const Triangle> triangles)> triangles;
  };

  /// `region` has the points of all triangles.
  QualityMesh(const Grid& grid, const GridRegion& region, Sink sink);

  /// Adds the next vertex of the plain mesh.
  void add_vertex(const PlainVertex& vertex);
  /// Adds the next triangle of the plain mesh. Its corners must have been added.
  void add_triangle(const Triangle& triangle);
  /// Finishes all triangles.
  void finish();

  /// Returns the position of a vertex. Valid for the corners of triangles while `Sink::triangles`
  /// is called with them.
  const Vec3& position_of(std::uint64_t number) const { return at(number).position; }
  /// Returns the normal of a vertex. Valid while `Sink::vertex` is called with it.
  const Vec3& normal_of(std::uint64_t number) const { return at(number).normal; }
  /// Returns the patch of a vertex. Valid like `position_of`.
  std::uint8_t patch_of(std::uint64_t number) const { return at(number).patch; }
  /// Returns the new number of a vertex that `Sink::vertex` has received.
  std::uint64_t new_number(std::uint64_t number) const {
    return new_numbers_[static_cast<Index>(number)];
  }

  /// Returns the counts and angles of all triangles that the sink has received.
  MeshQuality quality() const;

  /// Number of planes whose vertices and triangles are in the window.
  static int window_planes();
  /// Returns the estimated memory in bytes for this number of crossings between the planes of the
  /// window, with `more_bytes` for each vertex.
  static double memory_bytes(const GridRegion& region, double window_crossings, double more_bytes);

 private:
  // Numbers of vertices and triangles modulo 2^32, see SlidingList. A corner is 4 * triangle + 0, 1
  // or 2.
  using Index = std::uint32_t;
  static constexpr Index none = ~Index{0};
  using Corners = std::array<Index, 3>;

  struct alignas(64) Vertex {
    Vec3 position;
    std::int32_t z = 0;
    std::uint8_t valence = 0;  // number of corners
    std::uint8_t patch = 1;
    bool is_removed = false;
    bool is_at_cusp = false;  // corner of a delivered triangle at a cusp
    // Operations lead to at most `max_valence` corners.
    std::array<Index, max_vertex_triangles> corner_array{};  // the newest one is last
    Index mark = 0;
    Vec3 normal;

    std::span<const Index> corners() const { return std::span(corner_array).first(valence); }
  };
  static_assert(sizeof(Vertex) == 128);  // two cache lines; the first one has eight corners
  struct Face {
    Corners vertices{};       // the first one is `none` if the triangle was removed
    std::int32_t plane = 0;   // plane at which the triangle was added
    float quality = unknown;  // see `quality_of`

    // Return the vertices after, and before, a corner of the triangle.
    Index after(Index corner) const { return vertices[(corner & 3) < 2 ? (corner & 3) + 1 : 0]; }
    Index before(Index corner) const { return vertices[(corner & 3) > 0 ? (corner & 3) - 1 : 2]; }
  };
  static constexpr float unknown = -1;
  struct Plane {
    std::int32_t z = 0;
    Index first_vertex = 0;
    std::vector<Index> rows;  // first vertex of each row
  };
  struct FacePlane {
    std::int32_t z = 0;
    Index first_face = 0;
  };
  // A triangle at the centre of a ring.
  struct RingCorner {
    Index corner = 0;           // at the centre
    Index left = 0, right = 0;  // the other vertices
    Face* face = nullptr;
    const Vertex *at_left = nullptr, *at_right = nullptr;  // the vertices `left` and `right`
  };
  struct NearFace {
    Index face = 0;
    Bounds bounds;
  };
  struct Operation {
    float quality = 0;
    bool is_flip = false;
    Index from = 0, to = 0;  // collapse: vertices; flip: corners opposite to the edge
  };
  struct Limits {
    double max_squared_length = 0;
    float min_quality = 0;
  };

  const Vertex& at(std::uint64_t number) const { return vertices_[static_cast<Index>(number)]; }
  // Returns the number of a vertex in the window.
  std::uint64_t number_of(Index vertex) const {
    return vertex_end_ - (static_cast<Index>(vertex_end_) - vertex);
  }
  const Vec3& position(Index vertex) const { return vertices_[vertex].position; }
  // Return the corner after, or before, a corner of the same triangle.
  static Index after(Index corner) { return (corner & 3) < 2 ? corner + 1 : corner - 2; }
  static Index before(Index corner) { return (corner & 3) > 0 ? corner - 1 : corner + 2; }
  Index vertex_at(Index corner) const { return faces_[corner >> 2].vertices[corner & 3]; }
  TrianglePoints points(const Corners& triangle) const {
    return {position(triangle[0]), position(triangle[1]), position(triangle[2])};
  }
  // Returns the squared sine of the smallest angle.
  float quality_of(Face& face) const {
    if (face.quality == unknown) face.quality = computed_quality(face);
    return face.quality;
  }
  float quality_of(Index face) { return quality_of(faces_[face]); }
  float computed_quality(const Face& face) const;
  static double facing(const Vertex& a, const Vertex& b, const Vertex& c);
  double facing(const Corners& triangle) const;
  bool can_change(const Vertex& vertex) const;
  bool can_change(Index vertex) const { return can_change(vertices_[vertex]); }
  static bool can_have(const Face& face, const Vertex& vertex);
  Index corner_across(Index corner) const;

  static void link(Index corner, Vertex& vertex);
  void link(Index corner) { link(corner, vertices_[vertex_at(corner)]); }
  void unlink(Index corner);
  // Returns whether the triangle of a corner is in the window. This is true of all triangles at
  // vertices that may change, and at their neighbours.
  bool is_in_window(Index corner) const {
    const Index end = 4 * faces_.end();
    return end - corner <= end - 4 * faces_.first();
  }

  float best_quality() const { return operations_.empty() ? 0 : operations_.back().quality; }
  void list_ring(Index vertex);
  void list_ring_to_improve(Index vertex);
  bool has_too_many_neighbors(Index from, Index to) const;
  void consider_collapse(Index from, Index to);
  void consider_collapses(Index corner);
  void consider_all_collapses(Index vertex);
  void consider_flip(Index corner);
  bool is_collapsible(Index to) const;
  bool are_neighbors(Index one, Index other) const;
  bool perform_best();
  bool perform(const Operation& operation);
  void collapse(Index from, Index to);
  void flip(Index corner, Index other);
  bool do_intersect(const Bounds& bounds);
  Index first_from(double low_x, Index begin, Index end) const;
  void list_near_faces(const Bounds& bounds);
  bool intersect(const Corners& one, const Corners& other) const;

  Index end_of(std::size_t plane) const;
  std::pair<Index, Index> vertices_of(std::int32_t z) const;
  void advance_to(std::int32_t plane);
  void collapse_short_edges(std::int32_t plane);
  void improve_faces(std::int32_t plane);
  void freeze(std::int32_t plane);
  void deliver(std::int32_t plane);
  bool is_at_cusp(const Corners& triangle) const;
  bool is_near_cusp(const Corners& triangle) const;
  void count(Index index);
  void drop_delivered();

  Grid grid_;
  GridRegion region_;
  Sink sink_;
  std::int32_t plane_ = 0;   // the planes up to this one have been added
  std::int32_t frozen_ = 0;  // the vertices up to this plane are numbered
  bool has_plane_ = false;
  SlidingList<Vertex> vertices_;
  SlidingList<Face> faces_;
  SlidingList<std::uint64_t> new_numbers_;  // of the vertices
  std::uint64_t vertex_end_ = 0;            // number of vertices that were added
  std::deque<Plane> planes_;
  std::deque<FacePlane> face_planes_;
  FacingCells cells_;
  Index delivered_ = 0;  // the faces before this one are delivered
  std::uint64_t next_number_ = 0;
  Index ring_center_ = none;  // vertex whose ring is listed
  Index mark_ = 0;            // mark of the other vertices of the ring
  Limits limits_;
  MeshQuality quality_;
  double smallest_quality_ = 1;  // squared sine of the smallest angle
  // Scratch memory.
  std::vector<Operation> operations_;  // in ascending order of quality
  std::vector<RingCorner> ring_;
  std::vector<Index> old_faces_;
  std::vector<NearFace> near_faces_;
  std::vector<Corners> new_triangles_;
  std::vector<Triangle> delivered_triangles_;
};

}  // namespace eses::detail::mesh
