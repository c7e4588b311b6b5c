#pragma once
/// The receivers of the pieces of a mesh during the sweep.

#include <cstdint>

#include "mesh/piece.hpp"
#include "mesh/quality_filter.hpp"
#include "output/mesh_file.hpp"
#include "output/ordered_output.hpp"
#include "run/in_turn.hpp"

namespace eses::detail {

/// Receives the pieces of a mesh. Several threads call `take` for different pieces in any order.
class MeshSink {
 public:
  MeshSink() = default;
  MeshSink(const MeshSink&) = delete;
  MeshSink& operator=(const MeshSink&) = delete;
  virtual ~MeshSink() = default;

  /// Takes piece number `index`, from 0, and may change it. `scratch` is memory of the thread.
  virtual void take(std::int64_t index, mesh::MeshPiece& piece,
                    mesh::MeshFile::Scratch& scratch) = 0;
  /// Ends all waiting calls of `take` after a failure.
  virtual void abandon() = 0;
  /// Bytes that were written to a chunk.
  virtual std::uint64_t chunk_bytes() const { return 0; }
};

/// Writes the mesh to its file.
class MeshIntoFile final : public MeshSink {
 public:
  explicit MeshIntoFile(mesh::MeshFile& file) : file_(file) {}
  void take(std::int64_t index, mesh::MeshPiece& piece, mesh::MeshFile::Scratch& scratch) override {
    file_.add(index, piece, scratch);
  }
  void abandon() override { file_.abandon(); }

 private:
  mesh::MeshFile& file_;
};

/// Improves the triangles of the mesh.
class MeshIntoFilter final : public MeshSink {
 public:
  explicit MeshIntoFilter(mesh::QualityFilter& filter)
      : in_turn_([&filter](mesh::MeshPiece& piece) { filter.add(piece); }) {}
  void take(std::int64_t index, mesh::MeshPiece& piece, mesh::MeshFile::Scratch& scratch) override;
  void abandon() override { in_turn_.abandon(); }

 private:
  InTurn<mesh::MeshPiece> in_turn_;
};

/// Writes the pieces of the mesh to a chunk, see append_piece.
class MeshIntoChunk final : public MeshSink {
 public:
  explicit MeshIntoChunk(OrderedOutput::WriteAt write_at) : output_(std::move(write_at)) {}
  void take(std::int64_t index, mesh::MeshPiece& piece, mesh::MeshFile::Scratch& scratch) override;
  void abandon() override { output_.abandon(); }
  std::uint64_t chunk_bytes() const override { return output_.size(); }

 private:
  OrderedOutput output_;
};

}  // namespace eses::detail
