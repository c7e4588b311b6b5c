#include "run/output_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "io/bytes_text.hpp"
#include "io/map_formats.hpp"
#include "run/resources.hpp"

namespace eses {
namespace {

constexpr char residues_name[] = "residue_area.csv";
constexpr char chains_name[] = "chain_area.csv";
constexpr std::string_view gzip_suffix = ".gz";

std::string text_name(const char* name, bool gzip) {
  return fmt::format("{}{}", name, gzip ? gzip_suffix : "");
}

std::vector<std::string> text_names(const OutputChoice& choice, bool gzip) {
  std::vector<std::string> names;
  if (choice.box) names.push_back(text_name(box_name, gzip));
  if (choice.grid) names.push_back(text_name(grid_name, gzip));
  if (choice.edges) names.push_back(text_name(edges_name, gzip));
  if (choice.areas) names.push_back(text_name(areas_name, gzip));
  return names;
}

// Whether a run may write a file of this name.
bool is_ours(std::string_view name) {
  if (map_format(name) || mesh_format(name) || name == residues_name || name == chains_name)
    return true;
  if (name.ends_with(gzip_suffix)) name.remove_suffix(gzip_suffix.size());
  const std::array texts{box_name, grid_name, edges_name, areas_name};
  return std::any_of(texts.begin(), texts.end(), [&](const char* text) { return name == text; });
}

// The directory itself, or the nearest one above it that exists.
std::filesystem::path existing_part(std::filesystem::path directory) {
  std::error_code error;
  directory = std::filesystem::absolute(directory, error);
  while (!std::filesystem::exists(directory, error) && directory.has_relative_path())
    directory = directory.parent_path();
  return directory;
}

/// Where a file goes. Not by std::filesystem: see path_in.
struct FilePlace {
  std::string directory, name;
};

FilePlace place_of(const MeshChoice& mesh) {
  const std::string& path = mesh.file.native();
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {".", path};
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

}  // namespace

DiskSpace require_disk_space(const Plan& plan, const std::filesystem::path& directory) {
  const std::uint64_t texts = plan.gzip ? 0 : plan.grid_file_bytes + plan.area_file_bytes;
  const std::uint64_t certain = texts + plan.map_file_bytes + plan.scratch_bytes;
  const std::uint64_t available = available_disk(existing_part(directory));
  if (certain > available)
    throw Error(fmt::format(
        "the files need about {} besides intersection_info.txt, but {} has {} free; leave out "
        "grid_info.txt (--write edges,areas) or use a larger spacing",
        bytes_text(certain), directory.string(), bytes_text(available)));
  return {available, plan.output_bytes() + plan.scratch_bytes <= available};
}

std::vector<std::string> file_names(const OutputChoice& choice) {
  std::vector<std::string> names = text_names(choice, choice.gzip);
  if (choice.residues) names.insert(names.end(), {residues_name, chains_name});
  if (!choice.inside_map.empty()) names.push_back(choice.inside_map);
  return names;
}

namespace {

/// Of the chosen files and the mesh.
std::vector<FilePlace> places_of(const OutputChoice& choice,
                                 const std::filesystem::path& directory) {
  std::vector<FilePlace> places;
  for (std::string& name : file_names(choice))
    places.push_back({directory.native(), std::move(name)});
  if (choice.mesh) places.push_back(place_of(*choice.mesh));
  return places;
}

}  // namespace

std::vector<std::string> final_paths(const OutputChoice& choice,
                                     const std::filesystem::path& directory) {
  std::vector<std::string> paths;
  for (const FilePlace& place : places_of(choice, directory))
    paths.push_back(path_in(place.directory, place.name));
  return paths;
}

std::vector<std::string> temporary_paths(const OutputChoice& choice,
                                         const std::filesystem::path& directory) {
  std::vector<std::string> paths;
  for (const FilePlace& place : places_of(choice, directory))
    paths.push_back(path_in(place.directory, temporary_name(place.name, getpid())));
  return paths;
}

std::vector<std::string> lock_paths(const OutputChoice& choice,
                                    const std::filesystem::path& directory) {
  std::vector<std::string> paths;
  if (!file_names(choice).empty()) paths.push_back(lock_path(directory));
  if (choice.mesh) paths.push_back(lock_path(place_of(*choice.mesh).directory));
  return paths;
}

OutputFiles::OutputFiles(const OutputChoice& choice, const std::filesystem::path& path,
                         const Plan& plan)
    : gzip(choice.gzip), stale_(text_names(choice, !choice.gzip)) {
  if (!file_names(choice).empty()) open_directory(choice, path, plan);
  if (choice.mesh) open_mesh(*choice.mesh);
}

void OutputFiles::open_directory(const OutputChoice& choice, const std::filesystem::path& path,
                                 const Plan& plan) {
  directory.emplace(path);
  directory->remove_abandoned(is_ours);
  require_disk_space(plan, path);
  const auto open = [&](std::optional<OutputFile>& file, const char* name) {
    file.emplace(*directory, text_name(name, choice.gzip));
  };
  if (choice.box) open(box, box_name);
  if (choice.grid) open(grid, grid_name);
  if (choice.edges) open(edges, edges_name);
  if (choice.areas) open(areas, areas_name);
  if (choice.residues) {
    residues.emplace(*directory, residues_name);
    chains.emplace(*directory, chains_name);
  }
  if (!choice.inside_map.empty()) inside_map.emplace(*directory, choice.inside_map);
}

void OutputFiles::open_mesh(const MeshChoice& choice) {
  const auto [path, name] = place_of(choice);
  const bool is_elsewhere = !directory || !directory->is_at(path);
  OutputDirectory& place = is_elsewhere ? mesh_directory.emplace(path) : *directory;
  // Here that has been done, and files of this run are open by now.
  if (is_elsewhere) place.remove_abandoned(is_ours);
  mesh.emplace(place, name);
  mesh_triangles.emplace(path);
}

// The bounding box first.
std::vector<OutputFile*> OutputFiles::all() {
  std::vector<OutputFile*> files;
  for (auto* file : {&box, &grid, &edges, &areas, &inside_map, &residues, &chains, &mesh})
    if (*file) files.push_back(&**file);
  return files;
}

void OutputFiles::commit(const std::function<void()>& check) {
  std::vector<OutputFile*> files = all();
  for (OutputFile* file : files) {
    file->close();
    check();
  }
  try {
    for (OutputFile* file : files) file->remove_older();
    for (const std::string& name : stale_) directory->remove(name);
    std::reverse(files.begin(), files.end());
    for (OutputFile* file : files) {
      file->commit();
      check();
    }
  } catch (...) {
    for (OutputFile* file : files) file->withdraw();
    throw;
  }
  remove_resumable();
}

void OutputFiles::remove_resumable() noexcept {
  struct stat status {};
  if (!directory ||
      fstatat(directory->descriptor(), resume_name, &status, AT_SYMLINK_NOFOLLOW) != 0)
    return;
  std::error_code error;  // what is left does no harm
  std::filesystem::remove_all(path_in(directory->path(), resume_name), error);
}

}  // namespace eses
