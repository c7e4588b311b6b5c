#include "output/output_files.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "eses/error.hpp"
#include "input/eses_reader.hpp"
#include "output/file_path.hpp"
#include "output/mesh_format.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/hints.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// A file that a flag chooses.
struct FlaggedFile {
  RunFile file;
  bool Outputs::*is_chosen;
  std::string_view name;
  bool has_gzip;  // whether Outputs::gzip applies to it
};
constexpr std::array flagged_files{
    FlaggedFile{RunFile::box, &Outputs::box, name_of(EsesFile::box), true},
    FlaggedFile{RunFile::grid, &Outputs::grid, name_of(EsesFile::grid), true},
    FlaggedFile{RunFile::edges, &Outputs::edges, name_of(EsesFile::edges), true},
    FlaggedFile{RunFile::areas, &Outputs::areas, name_of(EsesFile::areas), true},
    FlaggedFile{RunFile::residues, &Outputs::residues, "residue_area.csv", false},
    FlaggedFile{RunFile::chains, &Outputs::residues, "chain_area.csv", false},
    FlaggedFile{RunFile::atoms, &Outputs::atoms, "atoms.csv", false}};

// A file of the output directory.
struct NamedFile {
  RunFile file;
  std::string name;
};

std::string name_on_disk(const FlaggedFile& file, bool gzip) {
  return formatted("{}{}", file.name, gzip && file.has_gzip ? gzip_suffix : "");
}

// Returns the chosen files without the mesh.
std::vector<NamedFile> named_files(const Outputs& choice) {
  std::vector<NamedFile> files;
  for (const FlaggedFile& file : flagged_files)
    if (choice.*file.is_chosen) files.push_back({file.file, name_on_disk(file, choice.gzip)});
  for (MapChoice& map : chosen_maps(choice))
    files.push_back({file_of(map.quantity), std::move(map.name)});
  return files;
}

// Returns the names of the chosen files in their other form, plain or compressed, if the choice of
// that form is not part of the name that the user gave.
std::vector<std::string> other_names(Outputs choice) {
  choice.gzip = !choice.gzip;
  std::vector<std::string> names;
  for (const FlaggedFile& file : flagged_files)
    if (file.has_gzip && choice.*file.is_chosen) names.push_back(name_on_disk(file, choice.gzip));
  for (MapChoice& map : chosen_maps(choice))
    if (is_of_edges(map.quantity)) names.push_back(std::move(map.name));
  return names;
}

// Whether a run that has locked the directory may write a file of this name.
bool is_ours(std::string_view name) {
  return map_format(name) || std::ranges::any_of(flagged_files, [name](const FlaggedFile& file) {
           return name == file.name || (file.has_gzip && name == name_on_disk(file, true));
         });
}

// Returns the paths of all files of a mesh, after following symbolic links.
std::vector<FilePath> mesh_paths(const MeshOptions& mesh) {
  std::vector<FilePath> paths;
  for (const std::filesystem::path& file : mesh_files(mesh)) paths.push_back(end_of_links(file));
  return paths;
}

// Returns the paths of the chosen files and of the mesh.
std::vector<FilePath> all_paths(const Outputs& choice, const std::filesystem::path& directory) {
  std::vector<FilePath> paths;
  for (NamedFile& file : named_files(choice))
    paths.push_back({directory.native(), std::move(file.name)});
  if (choice.mesh)
    for (FilePath& path : mesh_paths(*choice.mesh)) paths.push_back(std::move(path));
  return paths;
}

std::optional<dev_t> file_system_of(const std::filesystem::path& directory) {
  struct stat status {};
  if (stat(directory.c_str(), &status) != 0) return std::nullopt;
  return status.st_dev;
}

// Returns the demand on the file system of the output directory. If the mesh is in another file
// system, or if that is not known, its demand follows as a second entry.
std::vector<DiskSpace> disk_demands(const FileSizes& sizes, const Outputs& outputs,
                                    const std::filesystem::path& directory) {
  const std::uint64_t texts = outputs.gzip ? 0 : sizes.grid + sizes.areas;
  const std::uint64_t maps = sizes.maps - sizes.gzip_maps;
  std::vector<DiskSpace> demands{{.directory = directory,
                                  .certain = texts + maps,
                                  .expected = sizes.output() - sizes.mesh + sizes.text_scratch}};
  if (!outputs.mesh) return demands;
  const std::filesystem::path mesh_directory = mesh_directory_of(*outputs.mesh);
  const std::uint64_t of_mesh = sizes.mesh + sizes.mesh_scratch;
  const auto file_system = file_system_of(existing_part(mesh_directory));
  if (file_system && file_system == file_system_of(existing_part(directory))) {
    demands.front().expected += of_mesh;
  } else {
    demands.push_back({.directory = mesh_directory, .expected = of_mesh});
  }
  return demands;
}

void require_mesh_path(const std::filesystem::path& file) {
  const std::string directory = require_end_of_links(file).directory;
  if (std::filesystem::path(directory).filename() == checkpoint_name)
    throw Error(formatted("{} would go where runs keep what can be resumed, and be removed",
                          file.string()));
  require_replaceable(file);  // The message has the name that the user gave.
}

void require_different(std::span<const FilePath> paths) {
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (paths[i].name == paths[j].name &&
          is_same_directory(paths[i].directory, paths[j].directory))
        throw Error(formatted("two of the files would be the same one: {}; choose another name",
                              paths[i].text()));
}

// Throws Error with what a user can do. The command line adds the hints at the end of the message.
[[noreturn]] void refuse(const DiskSpace& space, const FileSizes& sizes, const Outputs& outputs) {
  std::string advice = "use a larger spacing";
  std::vector<std::string> hints{"spacing"};
  if (outputs.dielectric && !outputs.gzip) {
    advice += " or compress the files";
    hints.emplace_back("gzip");
  }
  if (sizes.grid > 0 && !outputs.gzip) {
    advice += " or leave out grid_info.txt";
    hints.emplace_back("write edges,areas");
  }
  throw HintedError(
      formatted("the files need about {}, but {} has {} free; {}", bytes_text(space.expected),
                space.directory.string(), bytes_text(space.available), advice),
      std::move(hints));
}

}  // namespace

std::vector<DiskSpace> require_disk_space(const FileSizes& sizes, const Outputs& outputs,
                                          const std::filesystem::path& directory) {
  std::vector<DiskSpace> spaces = disk_demands(sizes, outputs, directory);
  for (DiskSpace& space : spaces) {
    space.available = available_disk(existing_part(space.directory));
    if (space.certain > space.available) refuse(space, sizes, outputs);
  }
  return spaces;
}

std::string mesh_directory_of(const MeshOptions& mesh) {
  return mesh_paths(mesh).front().directory;
}

std::vector<std::string> file_names(const Outputs& choice) {
  std::vector<std::string> names;
  for (NamedFile& file : named_files(choice)) names.push_back(std::move(file.name));
  return names;
}

OutputPaths output_paths(const Outputs& choice, const std::filesystem::path& directory) {
  OutputPaths paths;
  for (const auto& [parent, name] : all_paths(choice, directory)) paths.add(parent, name);
  if (!file_names(choice).empty()) paths.locks.push_back(lock_path(directory));
  if (choice.mesh)
    for (const auto& [parent, name] : mesh_paths(*choice.mesh))
      paths.locks.push_back(lock_path(parent, name));
  return paths;
}

std::vector<std::string> stale_paths(const Outputs& choice,
                                     const std::filesystem::path& directory) {
  std::vector<std::string> paths;
  for (const std::string& name : other_names(choice)) paths.push_back(path_in(directory, name));
  return paths;
}

void require_writable_files(const Outputs& choice, const std::filesystem::path& directory) {
  if (!file_names(choice).empty()) require_writable(directory);
  if (choice.mesh)
    for (const std::filesystem::path& file : mesh_files(*choice.mesh)) require_mesh_path(file);
  const std::vector<FilePath> paths = all_paths(choice, directory);
  for (const FilePath& path : paths) require_free_name(path);
  require_different(paths);
  for (const std::string& path : stale_paths(choice, directory)) require_replaceable(path);
}

OutputFiles::OutputFiles(const Outputs& choice, const std::filesystem::path& path,
                         const FileSizes& sizes)
    : stale_(other_names(choice)) {
  require_writable_files(choice, path);
  require_disk_space(sizes, choice, path);
  if (const std::vector<NamedFile> files = named_files(choice); !files.empty()) {
    directory_.emplace(path);
    directory_->remove_abandoned(is_ours);
    for (const auto& [file, name] : files) open(*directory_, file, name);
  }
  if (choice.mesh) open_mesh(*choice.mesh);
}

void OutputFiles::open_mesh(const MeshOptions& choice) {
  const std::vector<FilePath> paths = mesh_paths(choice);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto& [directory, name] = paths[i];
    open(mesh_directories_[i].emplace(directory, name),
         i == 0 ? RunFile::mesh : RunFile::mesh_faces, name);
  }
}

std::uint64_t OutputFiles::size() const {
  std::uint64_t bytes = 0;
  for (const auto& file : files_)
    if (file) bytes += file->size();
  return bytes;
}

void OutputFiles::commit(const std::function<void()>& check) {
  const auto remove_stale = [this] {
    for (const std::string& name : stale_) directory_->remove(name);
  };
  commit_all(files_, remove_stale, check);
}

}  // namespace eses::detail
