#pragma once
/// The output files of a run, of which either all or none get their final names.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "output/file_sizes.hpp"
#include "output/map_writer.hpp"
#include "output/output_directory.hpp"
#include "output/output_file.hpp"

namespace eses::detail {

/// Name of the checkpoint directory in the output directory.
inline constexpr char checkpoint_name[] = ".eses-blocks.resume";

/// Name of the file in the checkpoint directory that identifies the run.
inline constexpr char run_name[] = "run";
/// Suffix of the checksum file that marks a chunk as complete.
inline constexpr char sums_suffix[] = ".sums";

/// Removes a checkpoint directory with all its files. If the removal is interrupted, the remaining
/// chunks can still be recognized as incomplete.
void remove_checkpoint_directory(const std::filesystem::path& directory) noexcept;

/// Names of the chosen files, without the mesh.
std::vector<std::string> file_names(const Outputs& choice);

/// Final paths of the chosen files and of the mesh.
std::vector<std::string> final_paths(const Outputs& choice, const std::filesystem::path& directory);

/// Paths of the chosen text files and maps of the dielectric in their other form, plain or
/// compressed. `commit` removes them.
std::vector<std::string> stale_paths(const Outputs& choice, const std::filesystem::path& directory);

/// Directory of the mesh's first file, after following symbolic links.
std::string mesh_directory_of(const MeshOptions& mesh);

/// Checks, without writing, that all files of a run can be written. Throws Error if a directory
/// cannot be written to, if the path of an output file or of stale_paths is something else than a
/// regular file, or if two of the output files are the same file, perhaps by symbolic links.
void require_writable_files(const Outputs& choice, const std::filesystem::path& directory);

/// Paths under which this process writes the files until they are complete.
std::vector<std::string> temporary_paths(const Outputs& choice,
                                         const std::filesystem::path& directory);

/// Paths of the lock files of a run.
std::vector<std::string> lock_paths(const Outputs& choice, const std::filesystem::path& directory);

/// Available and expected disk space, for each file system of the output.
struct DiskSpace {
  struct Place {
    std::filesystem::path directory;
    std::uint64_t available = 0;  ///< bytes; the largest number if it is not known
    std::uint64_t expected = 0;   ///< bytes, with those of temporary data
  };
  /// The output directory; then the directory of the mesh if it is in another file system.
  std::vector<Place> places;
};

/// Returns the disk space for files of these sizes. The output directory and the directory of the
/// mesh need not exist yet. Throws Error if the files whose sizes are known do not fit.
DiskSpace require_disk_space(const FileSizes& sizes, const Outputs& outputs,
                             const std::filesystem::path& directory);

/// The open output files of a run, such as `edges` for intersection_info.txt. Only the chosen ones
/// have a value. Only `commit` changes files that have final names.
struct OutputFiles {
  bool gzip = false;  ///< whether box, grid, edges and areas are compressed
  /// The output directory, if any file other than the mesh is chosen.
  std::optional<OutputDirectory> directory;
  /// Directories of the mesh file and of the separate file of its triangles, if the format has one.
  /// Each is locked for its file alone.
  std::optional<OutputDirectory> mesh_directory, face_directory;
  std::optional<OutputFile> box, grid, edges, areas, residues, chains, atoms, mesh, mesh_faces;
  std::array<std::optional<OutputFile>, map_quantities> maps;  ///< by quantity

  /// Opens the files. Throws the errors of require_writable_files, OutputDirectory, OutputFile and
  /// require_disk_space.
  OutputFiles(const Outputs& choice, const std::filesystem::path& path, const FileSizes& sizes);

  /// The file of a map; null if there is none.
  OutputFile* map(MapQuantity quantity) {
    auto& file = maps[static_cast<std::size_t>(quantity)];
    return file ? &*file : nullptr;
  }

  /// Gives all files their final names. Older files are removed first, so that old and new files
  /// never exist together. The bounding box is renamed last, so that its presence means that all
  /// files are complete. `check` is called between the steps. After an exception, from `check` or
  /// otherwise, none of the files exists.
  void commit(const std::function<void()>& check);

  /// Removes the checkpoint after a successful `commit`.
  void remove_checkpoint() noexcept;

 private:
  void open_directory(const Outputs& choice, const std::filesystem::path& path);
  void open_mesh(const MeshOptions& choice);
  std::vector<OutputFile*> all();

  std::vector<std::string>
      stale_;  // names of the chosen files in their other form, see stale_paths
};

}  // namespace eses::detail
