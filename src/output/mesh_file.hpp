#pragma once
/// The file of a mesh, written from pieces.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "eses/summary.hpp"
#include "mesh/piece.hpp"
#include "output/file.hpp"
#include "output/mesh_formatter.hpp"
#include "output/text_buffer.hpp"

namespace eses::detail::mesh {

/// Writes a mesh. The first section of a file is written behind the space for its header. The other
/// sections are written to scratch files, as the length of the first one is not known, and `finish`
/// copies them. The memory does not grow with the mesh.
class MeshFile {
 public:
  /// The sections of a piece as texts, and the offset of each in its section.
  struct Texts {
    std::vector<TextBuffer> sections;
    std::vector<std::uint64_t> offsets;
  };

  /// `face_file` is the file of the triangles if the format has one, else null. Keeps references to
  /// the files. Scratch files are in the directory `scratch`.
  MeshFile(MeshFormatter formatter, OutputFile& file, OutputFile* face_file,
           const std::filesystem::path& scratch);

  // A piece passes three steps.
  /// Formats a piece. Several threads may call it.
  void format(const MeshPiece& piece, Texts& texts) const;
  /// Counts a piece and sets its offsets. One thread at a time calls it, in the order of the
  /// pieces.
  void place(const MeshPiece& piece, Texts& texts);
  /// Writes a piece. Several threads may call it.
  void write(const Texts& texts);
  /// Performs all steps for the next piece.
  void add(const MeshPiece& piece);

  /// The vertices and triangles that were added.
  const MeshCounts& counts() const { return counts_; }
  /// Completes the files after all pieces were added. Calls `check` repeatedly. Throws Error if the
  /// mesh is too large for its format.
  void finish(const std::function<void()>& check);

 private:
  // A section of the file, or of a scratch file.
  struct Section {
    std::optional<ScratchFile> scratch;
    File* file = nullptr;
    std::uint64_t begin = 0;  // in the file
    std::uint64_t size = 0;   // of all pieces
  };
  bool is_first_of_file(std::size_t section) const {
    return section == 0 || (section == 1 && face_file_ != nullptr);
  }
  std::uint64_t write_header_of(std::size_t section);
  void write_ends(std::uint64_t begin, const std::function<void()>& check);

  MeshFormatter formatter_;
  OutputFile& file_;
  OutputFile* face_file_;
  std::deque<Section> sections_;
  MeshCounts counts_;
  VertexBox box_;
  Texts texts_;  // for `add`
};

}  // namespace eses::detail::mesh
