#pragma once
/// The file of a mesh, written from pieces.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "eses/summary.hpp"
#include "mesh/piece.hpp"
#include "output/file.hpp"
#include "output/mesh_writer.hpp"
#include "output/ordered_output.hpp"
#include "output/output_file.hpp"

namespace eses::detail::mesh {

/// Writes a mesh. The first section of a file is written behind the space for its header. The other
/// sections are written to scratch files, as the length of the first one is not known, and `finish`
/// copies them. The memory does not grow with the mesh.
class MeshFile {
 public:
  /// Writes the header of the mesh file. Its length does not depend on the counts and the box.
  using WriteHeader = std::function<void(BufferedText& text, const MeshCounts&, const VertexBox&)>;
  /// Texts of the sections of a piece.
  using Scratch = std::vector<TextBuffer>;

  /// `face_file` is the file of the triangles if the format has one, else null. Keeps references to
  /// `text` and the files. Scratch files are in the directory `scratch`.
  MeshFile(const MeshText& text, WriteHeader write_header, OutputFile& file, OutputFile* face_file,
           const std::filesystem::path& scratch);

  /// Adds piece number `index`. Several threads may add pieces in any order; each waits until all
  /// pieces with smaller numbers have their place.
  void add(std::int64_t index, const MeshPiece& piece, Scratch& texts);
  /// Adds the next piece. One thread alone may call it.
  void add(const MeshPiece& piece) { add(next_++, piece, texts_); }
  /// Ends all waiting calls of `add` after a failure.
  void abandon();

  /// The vertices and triangles that were added.
  const MeshCounts& counts() const { return counts_; }
  /// Completes the files after all pieces were added. Returns their length in bytes. Calls `check`
  /// repeatedly. Throws Error if the mesh is too large for its format.
  std::uint64_t finish(const std::function<void()>& check);

 private:
  struct Section {
    // Writes the section to a file from `begin` on.
    Section(File& file, std::uint64_t begin);
    // Writes the section to a scratch file.
    explicit Section(const std::filesystem::path& directory);

    std::optional<ScratchFile> scratch;
    OrderedOutput output;
  };
  bool is_first_of_file(std::size_t section) const {
    return section == 0 || (section == 1 && face_file_ != nullptr);
  }
  std::uint64_t write_header_of(std::size_t section);
  std::uint64_t write_ends(std::uint64_t begin, const std::function<void()>& check);

  const MeshText& text_;
  WriteHeader write_header_;
  OutputFile& file_;
  OutputFile* face_file_;
  std::deque<Section> sections_;
  std::mutex mutex_;
  MeshCounts counts_;
  VertexBox box_;
  std::int64_t next_ = 0;  // number of the next piece of one thread alone
  Scratch texts_;
};

}  // namespace eses::detail::mesh
