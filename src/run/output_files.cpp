#include "run/output_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <system_error>

#include "eses/error.hpp"
#include "run/resources.hpp"

namespace eses {
namespace {

constexpr char box_name[] = "bounding_box.txt";
constexpr char grid_name[] = "grid_info.txt";
constexpr char edges_name[] = "intersection_info.txt";
constexpr char areas_name[] = "partition_area.txt";

// The directory itself, or the nearest one above it that exists.
std::filesystem::path existing_part(std::filesystem::path directory) {
  std::error_code error;
  directory = std::filesystem::absolute(directory, error);
  while (!std::filesystem::exists(directory, error) && directory.has_relative_path())
    directory = directory.parent_path();
  return directory;
}

/// Where a mesh goes. Not by std::filesystem: see path_in.
struct MeshPlace {
  std::string directory, name;
};

MeshPlace place_of(const MeshChoice& mesh) {
  const std::string& path = mesh.file.native();
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {".", path};
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

}  // namespace

DiskSpace require_disk_space(const Plan& plan, const std::filesystem::path& directory) {
  const std::uint64_t certain = plan.grid_file_bytes + plan.area_file_bytes;
  const std::uint64_t available = available_disk(existing_part(directory));
  if (certain > available)
    throw Error(fmt::format(
        "the files need about {:.3g} GB besides intersection_info.txt, but {} has {:.3g} "
        "GB free; leave out grid_info.txt (--write edges,areas) or use a larger spacing",
        static_cast<double>(certain) / 1e9, directory.string(),
        static_cast<double>(available) / 1e9));
  return {available, plan.output_bytes() <= available};
}

std::vector<std::string> file_names(const OutputChoice& choice) {
  std::vector<std::string> names;
  if (choice.box) names.emplace_back(box_name);
  if (choice.grid) names.emplace_back(grid_name);
  if (choice.edges) names.emplace_back(edges_name);
  if (choice.areas) names.emplace_back(areas_name);
  return names;
}

std::vector<std::string> temporary_paths(const OutputChoice& choice,
                                         const std::filesystem::path& directory) {
  std::vector<std::string> paths;
  for (const std::string& name : file_names(choice))
    paths.push_back(path_in(directory, temporary_name(name, getpid())));
  if (choice.mesh) {
    const auto [mesh_directory, name] = place_of(*choice.mesh);
    paths.push_back(path_in(mesh_directory, temporary_name(name, getpid())));
  }
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
                         const Plan& plan) {
  if (!file_names(choice).empty()) open_directory(choice, path, plan);
  if (choice.mesh) open_mesh(*choice.mesh);
}

void OutputFiles::open_directory(const OutputChoice& choice, const std::filesystem::path& path,
                                 const Plan& plan) {
  directory.emplace(path);
  directory->remove_abandoned(file_names({}));
  require_disk_space(plan, path);
  if (choice.box) box.emplace(*directory, box_name);
  if (choice.grid) grid.emplace(*directory, grid_name);
  if (choice.edges) edges.emplace(*directory, edges_name);
  if (choice.areas) areas.emplace(*directory, areas_name);
}

void OutputFiles::open_mesh(const MeshChoice& choice) {
  const auto [path, name] = place_of(choice);
  const bool is_elsewhere = !directory || !directory->is_at(path);
  OutputDirectory& place = is_elsewhere ? mesh_directory.emplace(path) : *directory;
  place.remove_abandoned(std::array{name});
  mesh.emplace(place, name);
  mesh_triangles.emplace(path);
}

// The bounding box first.
std::vector<OutputFile*> OutputFiles::all() {
  std::vector<OutputFile*> files;
  for (auto* file : {&box, &grid, &edges, &areas, &mesh})
    if (*file) files.push_back(&**file);
  return files;
}

void OutputFiles::commit(const std::function<void()>& check) {
  const std::vector<OutputFile*> files = all();
  for (OutputFile* file : files) {
    file->close();
    check();
  }
  try {
    for (OutputFile* file : files) file->remove_older();
    for (auto file = files.rbegin(); file != files.rend(); ++file) {
      (*file)->commit();
      check();
    }
  } catch (...) {
    for (OutputFile* file : files) file->withdraw();
    throw;
  }
}

}  // namespace eses
