#pragma once
/// The output files of a run, of which either all or none get their final names.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "output/file.hpp"
#include "output/grid_map.hpp"
#include "output/output_directory.hpp"

namespace eses::detail {

/// Name of the checkpoint directory in the output directory.
inline constexpr char checkpoint_name[] = ".eses-blocks.resume";

/// The files that a run can write. Maps are in the order of MapQuantity.
enum class RunFile : std::uint8_t {
  box,
  grid,
  edges,
  areas,
  residues,
  chains,
  atoms,
  first_map,
  mesh = static_cast<std::uint8_t>(first_map) + map_quantities,
  mesh_faces,  ///< the separate file of the triangles, if the mesh has one
};
inline constexpr std::size_t run_file_count = static_cast<std::size_t>(RunFile::mesh_faces) + 1;

/// Returns the file of a map.
constexpr RunFile file_of(MapQuantity quantity) {
  return static_cast<RunFile>(static_cast<std::size_t>(RunFile::first_map) +
                              static_cast<std::size_t>(quantity));
}

/// Names of the chosen files, without the mesh.
std::vector<std::string> file_names(const Outputs& choice);

/// Paths of the chosen files and of the mesh.
OutputPaths output_paths(const Outputs& choice, const std::filesystem::path& directory);

/// Paths of the chosen text files and maps of the dielectric in their other form, plain or
/// compressed. `commit` removes them.
std::vector<std::string> stale_paths(const Outputs& choice, const std::filesystem::path& directory);

/// Directory of the mesh's first file, after following symbolic links.
std::string mesh_directory_of(const MeshOptions& mesh);

/// Checks, without writing, that all files of a run can be written. Throws Error if a directory
/// cannot be written to, if the path of an output file or of stale_paths is something else than a
/// regular file, or if two of the output files are the same file, perhaps by symbolic links.
void require_writable_files(const Outputs& choice, const std::filesystem::path& directory);

/// Sizes of the output files and of the scratch files during the run, in bytes. 0 for files that
/// are not written. The sizes of compressed files are estimates.
struct FileSizes {
  std::uint64_t box = 0;       ///< exact
  std::uint64_t grid = 0;      ///< upper bound
  std::uint64_t edges = 0;     ///< estimate
  std::uint64_t areas = 0;     ///< upper bound
  std::uint64_t residues = 0;  ///< estimate
  std::uint64_t atoms = 0;     ///< estimate
  std::uint64_t maps = 0;      ///< exact, except for compressed maps
  std::uint64_t mesh = 0;      ///< estimate

  std::uint64_t gzip_maps = 0;     ///< compressed maps, included in `maps`; estimate
  std::uint64_t mesh_scratch = 0;  ///< scratch files of the mesh; estimate
  /// Texts, rows of maps and pieces of the mesh in chunks; 0 if texts are written in place.
  /// Estimate.
  std::uint64_t text_scratch = 0;

  /// Total size of the output files.
  std::uint64_t output() const {
    return box + grid + edges + areas + residues + atoms + maps + mesh;
  }
  /// Total size of the scratch files.
  std::uint64_t scratch() const { return mesh_scratch + text_scratch; }
};

/// The bytes that a run writes to a file system, and the space that is available there.
struct DiskSpace {
  std::filesystem::path directory;
  std::uint64_t certain = 0;    ///< bytes of files whose sizes are known
  std::uint64_t expected = 0;   ///< estimate of all bytes, including temporary data
  std::uint64_t available = 0;  ///< bytes; the largest number if it is not known
};

/// Returns the space for files of these sizes: in the file system of the output directory, and in
/// that of the mesh if it is another one. The directories need not exist yet. Throws Error if the
/// files whose sizes are known do not fit.
std::vector<DiskSpace> require_disk_space(const FileSizes& sizes, const Outputs& outputs,
                                          const std::filesystem::path& directory);

/// The open output files of a run. Only `commit` changes files that have final names.
class OutputFiles {
 public:
  /// Opens the chosen files. Throws the errors of require_writable_files, OutputDirectory,
  /// OutputFile and require_disk_space.
  OutputFiles(const Outputs& choice, const std::filesystem::path& path, const FileSizes& sizes);

  /// Returns a file, or null if it is not chosen.
  OutputFile* find(RunFile file) { return files_[static_cast<std::size_t>(file)].get(); }

  /// Total number of bytes in the files, before `commit`.
  std::uint64_t size() const;

  /// Gives all files their final names. Older files are removed first, so that old and new files
  /// never exist together. The bounding box is renamed last, so that its presence means that all
  /// files are complete. `check` is called between the steps. After an exception, from `check` or
  /// otherwise, none of the files exists.
  void commit(const std::function<void()>& check);

 private:
  void open(const OutputDirectory& directory, RunFile file, const std::string& name) {
    files_[static_cast<std::size_t>(file)] = std::make_unique<OutputFile>(directory, name);
  }
  void open_mesh(const MeshOptions& choice);

  /// The output directory, if any file other than the mesh is chosen.
  std::optional<OutputDirectory> directory_;
  /// Directories of the mesh file and of the separate file of its triangles, if the format has one.
  /// Each is locked for its file alone.
  std::array<std::optional<OutputDirectory>, 2> mesh_directories_;
  std::array<std::unique_ptr<OutputFile>, run_file_count> files_;  ///< by RunFile
  /// Names of the chosen files in their other form, see stale_paths.
  std::vector<std::string> stale_;
};

}  // namespace eses::detail
