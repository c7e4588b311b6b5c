#pragma once
/// The improvement of a mesh that is read as a stream, and its result as vertices and triangles.

#include <cstdint>
#include <span>
#include <vector>

#include "eses/summary.hpp"
#include "mesh/quality_mesh.hpp"
#include "output/eses_writer.hpp"
#include "output/mesh_writer.hpp"
#include "output/ordered_output.hpp"

namespace eses::detail {

// A batch of a mesh for QualityPass has its length in bytes and the number of its vertices; the
// vertices with their text in the mesh's format; and triangles as mesh::LocalTriangle. The corners
// of a triangle are in its batch or before it.

/// Begins a batch in an empty buffer. Vertices and then triangles follow.
void begin_batch(TextBuffer& batch);
/// Appends a vertex. `y` is its row in the region of the mesh.
void append_streamed_vertex(TextBuffer& batch, const mesh::MeshText& text,
                            const mesh::Vertex& vertex, std::int64_t y);
/// Completes a batch. A batch without vertices and triangles becomes empty.
void end_batch(TextBuffer& batch, std::uint64_t vertices);
/// Typical size in bytes of a vertex and its two triangles in the stream.
std::uint64_t streamed_vertex_bytes(std::uint64_t text_bytes);

/// Improves the triangles of a mesh. See mesh::QualityMesh.
class QualityPass {
 public:
  /// The receivers of the result: vertices and triangles as text or records of the mesh's format.
  struct Sinks {
    OrderedOutput::WriteAt vertices, triangles;
    /// Whether triangles are passed as mesh::LocalTriangle, with indices of vertices in the whole
    /// mesh. Ignored if the format has the positions of the corners.
    bool has_local_triangles = false;
  };
  /// Keeps a reference to `text`.
  QualityPass(const mesh::MeshText& text, const Grid& grid, const GridRegion& region, Sinks sinks);

  /// Begins the stream of a chunk of planes. `first_vertex` is the number of vertices before it.
  void begin_chunk(std::uint64_t first_vertex) { first_vertex_ = first_vertex; }
  /// Adds a part of the stream.
  void add(std::span<const char> bytes);
  /// Finishes the mesh.
  void finish();

  /// Returns the estimated memory in bytes. `plane_crossings` is the expected number of crossings
  /// of a plane. `is_in_place` is true if the stream comes from the sweep, and false if it is read
  /// from chunks.
  static double memory_bytes(const MeshOptions& mesh, const GridRegion& region,
                             double plane_crossings, bool is_in_place);

  /// These are the figures of the finished mesh.
  MeshCounts counts() const { return counts_; }
  MeshQuality quality() const { return mesh_.quality(); }
  std::uint64_t vertex_bytes() const { return vertex_bytes_; }
  std::uint64_t triangle_bytes() const { return triangle_bytes_; }

 private:
  std::size_t add_batch(std::span<const char> bytes);
  void take_vertex(std::uint64_t number);
  void take_triangles(std::span<const mesh::Triangle> triangles);
  void flush(std::size_t min_bytes);

  const mesh::MeshText& text_;
  Sinks sinks_;
  std::uint64_t first_vertex_ = 0;
  std::vector<char> rest_;  // the begin of a batch that is not complete
  // Texts of the vertices of the window. Text i ends where text i + 1 begins.
  std::vector<char> texts_;
  std::vector<std::size_t> text_begins_{0};
  std::uint64_t first_text_ = 0;         // number of the vertex of the first text
  std::uint64_t next_vertex_ = 0;        // texts before this vertex are not needed any more
  std::vector<mesh::Triangle> numbers_;  // scratch memory: triangles with new numbers
  TextBuffer vertices_, triangles_;
  std::uint64_t vertex_bytes_ = 0, triangle_bytes_ = 0;  // bytes that the sinks have received
  MeshCounts counts_;
  mesh::QualityMesh mesh_;
};

}  // namespace eses::detail
