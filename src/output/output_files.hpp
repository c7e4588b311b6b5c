#pragma once
/// The files of a run: all of them, or none.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/map_writer.hpp"
#include "output/output_directory.hpp"
#include "output/output_file.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Of the text files, if they are not gzipped.
inline constexpr char box_name[] = "bounding_box.txt";
inline constexpr char grid_name[] = "grid_info.txt";
inline constexpr char edges_name[] = "intersection_info.txt";
inline constexpr char areas_name[] = "partition_area.txt";

/// Of one of them, plain or gzipped.
std::string text_file_name(const char* name, bool gzip);

/// Where a run that may be resumed keeps what is done, in its output directory.
inline constexpr char checkpoint_name[] = ".eses-blocks.resume";

/// In it, what says of which run it is, and the suffix of what says that a piece is complete.
inline constexpr char run_name[] = "run";
inline constexpr char sums_suffix[] = ".sums";

/// Removes the directory of that name with all that is in it. If that is cut off, what is left of
/// the pieces in it can still be told from complete ones.
void remove_checkpoint_directory(const std::filesystem::path& directory) noexcept;

/// The names of the chosen files, the mesh left out.
std::vector<std::string> file_names(const Outputs& choice);

/// Where these and the mesh are in the end.
std::vector<std::string> final_paths(const Outputs& choice, const std::filesystem::path& directory);

/// What is removed besides, as it is another form of one of them.
std::vector<std::string> stale_paths(const Outputs& choice, const std::filesystem::path& directory);

/// The directory of the mesh's first file; if that is a symbolic link, of the file to which it
/// leads.
std::string mesh_directory_of(const MeshOptions& mesh);

/// Throws Error if one of the files cannot be written where it goes, as far as can be told without
/// writing there: its directory is none, or not to be written to, or its name leads to something
/// else than a regular file. The same holds for stale_paths, which would be removed. Throws Error,
/// too, if two of the files are the same one, as by symbolic links.
void require_places(const Outputs& choice, const std::filesystem::path& directory);

/// Where this process writes them until they are complete.
std::vector<std::string> temporary_paths(const Outputs& choice,
                                         const std::filesystem::path& directory);

/// The files that it locks.
std::vector<std::string> lock_paths(const Outputs& choice, const std::filesystem::path& directory);

/// What the file systems of a plan's files have to give, and what goes there.
struct DiskSpace {
  struct Place {
    std::filesystem::path directory;
    std::uint64_t available = 0;  ///< bytes; the largest number if that cannot be told
    std::uint64_t expected = 0;   ///< bytes of files, and beside them while they are being made
  };
  /// The output directory; then that of the mesh, if it is in another file system.
  std::vector<Place> places;
};

/// The disk space for a plan's files in `directory` and that of the mesh, neither of which need
/// exist yet. Throws Error if those whose size is known do not fit.
DiskSpace require_disk_space(const Plan& plan, const Outputs& outputs,
                             const std::filesystem::path& directory);

/// Each file is there only if it was chosen. Nothing but `commit` touches what has a final name.
struct OutputFiles {
  bool gzip = false;                         ///< whether box, grid, edges and areas are gzipped
  std::optional<OutputDirectory> directory;  ///< if any file but the mesh is there
  /// If there is a mesh, of its file, and of that of its triangles if they have one; each locked
  /// for that file alone.
  std::optional<OutputDirectory> mesh_directory, face_directory;
  std::optional<OutputFile> box, grid, edges, areas, residues, chains, mesh, mesh_faces;
  std::array<std::optional<OutputFile>, map_quantities> maps;  ///< by quantity

  /// Throws Error as require_places, OutputDirectory, OutputFile and require_disk_space do.
  OutputFiles(const Outputs& choice, const std::filesystem::path& path, const Plan& plan);

  /// The file of a map; null if there is none.
  OutputFile* map(MapQuantity quantity) {
    auto& file = maps[static_cast<std::size_t>(quantity)];
    return file ? &*file : nullptr;
  }

  /// Gives all files their names. Older ones go first, so that old and new never stand beside each
  /// other, and the bounding box comes last: where it is, the others are. What `check`, called
  /// between the steps, throws is a failure like others, after which none of the files is there.
  void commit(const std::function<void()>& check);

  /// After it: what was kept for a run to be resumed has served, and goes.
  void remove_checkpoint() noexcept;

 private:
  void open_directory(const Outputs& choice, const std::filesystem::path& path);
  void open_mesh(const MeshOptions& choice);
  std::vector<OutputFile*> all();

  std::vector<std::string> stale_;  // the chosen files in their other form, plain or gzipped
};

}  // namespace eses::detail
