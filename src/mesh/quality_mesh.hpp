#pragma once
/// Improvement of the triangles of a mesh in a window that slides along z.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "eses/summary.hpp"
#include "eses/vec3.hpp"
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
/// corners, and if no new triangle intersects another triangle (see `is_free`). Vertices at the
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
    /// Called for each triangle after the calls of `vertex` for its corners.
    std::function<void(const Triangle& triangle)> triangle;
  };

  QualityMesh(double spacing, Sink sink);

  /// Adds the next vertex of the plain mesh.
  void add_vertex(const PlainVertex& vertex);
  /// Adds the next triangle of the plain mesh. Its corners must have been added.
  void add_triangle(const Triangle& triangle);
  /// Finishes all triangles.
  void finish();

  /// Returns a vertex. Valid for the corners of a triangle while `Sink::triangle` is called.
  const PlainVertex& vertex(std::uint64_t number) const { return at(number).plain; }
  /// Returns the new number of a vertex that `Sink::vertex` has received.
  std::uint64_t new_number(std::uint64_t number) const { return at(number).new_number; }

  /// Returns the counts and angles of all triangles that the sink has received.
  const MeshQuality& quality() const { return quality_; }
  std::uint64_t vertex_count() const { return next_number_; }

  /// Returns the estimated memory in bytes for this number of crossings of a plane, with
  /// `more_bytes` for each vertex of the window.
  static double memory_bytes(double plane_crossings, double more_bytes);

 private:
  // Indices of vertices and triangles in the window. A corner is 4 * triangle + 0, 1 or 2.
  using Index = std::uint32_t;
  static constexpr Index none = ~Index{0};

  struct Vertex {
    PlainVertex plain;
    Index first_corner = none;  // head of the list of the corners at this vertex
    std::int32_t valence = 0;   // length of the list
    Index mark = 0;
    bool is_removed = false;
    std::uint64_t new_number = 0;
  };
  struct Face {
    std::array<Index, 3> vertices{};  // the first one is `none` if the triangle was removed
    std::array<Index, 3> next{};      // next corner in the list of each vertex
    std::int32_t plane = 0;           // plane at which the triangle was added
    Index mark = 0;
  };
  struct Plane {
    std::int32_t z = 0;
    Index first_vertex = 0;
    std::vector<Index> rows;  // first vertex of each row
  };
  struct FacePlane {
    std::int32_t z = 0;
    Index first_face = 0;
  };
  struct Operation {
    double quality = 0;
    bool is_flip = false;
    Index from = 0, to = 0;  // collapse: vertices; flip: corners opposite to the edge
  };
  struct Limits {
    double max_squared_length = 0, min_quality = 0;
  };
  struct Bounds {
    Vec3 low, high;
  };

  const Vertex& at(std::uint64_t number) const { return vertices_[number - first_number_]; }
  const Vec3& position(Index vertex) const { return vertices_[vertex].plain.position; }
  Index corner_vertex(Index corner, Index step) const {
    return faces_[corner >> 2].vertices[((corner & 3) + step) % 3];
  }
  Index next_corner(Index corner) const { return faces_[corner >> 2].next[corner & 3]; }
  TrianglePoints points(const std::array<Index, 3>& triangle) const {
    return {position(triangle[0]), position(triangle[1]), position(triangle[2])};
  }
  double facing(const std::array<Index, 3>& triangle) const;
  bool can_change(Index vertex) const;
  bool can_have(const Face& face, Index vertex) const;
  Index corner_across(Index corner) const;

  void link(Index corner);
  void unlink(Index corner);

  void mark_ring(Index vertex);
  void consider_collapses(Index vertex, double max_squared_edge);
  void consider_collapse(Index from, Index to);
  void consider_flip(Index corner);
  bool perform_best();
  void collapse(Index from, Index to);
  void flip(Index corner, Index other);
  bool is_free(std::span<const Index> old_faces, std::span<const std::array<Index, 3>> triangles);
  bool gather(const Bounds& bounds, const Vec3& direction, std::span<const Index> old_faces);
  bool intersect(const std::array<Index, 3>& one, const std::array<Index, 3>& other) const;

  void advance_to(std::int32_t plane);
  void collapse_short_edges(std::int32_t plane);
  void improve_faces(std::int32_t plane, double min_angle_quality);
  void freeze(std::int32_t plane);
  void deliver(std::int32_t plane);
  void count(const Face& face);
  void drop_delivered();

  double spacing_;
  Sink sink_;
  std::int32_t plane_ = 0;   // the planes up to this one have been added
  std::int32_t frozen_ = 0;  // the vertices up to this plane are numbered
  bool has_plane_ = false;
  std::vector<Vertex> vertices_;
  std::vector<Face> faces_;
  std::uint64_t first_number_ = 0;  // number of the first vertex of the window
  std::deque<Plane> planes_;
  std::deque<FacePlane> face_planes_;
  Index delivered_ = 0;  // number of faces at the begin of the window that are delivered
  std::uint64_t next_number_ = 0;
  Index mark_ = 0, face_mark_ = 0;
  Limits limits_;
  MeshQuality quality_;
  // Scratch memory.
  std::vector<Operation> operations_;
  std::vector<Index> ring_corners_, old_faces_, near_faces_;
  std::vector<std::array<Index, 3>> new_triangles_;
};

}  // namespace eses::detail::mesh
