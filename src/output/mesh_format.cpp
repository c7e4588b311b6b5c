#include "output/mesh_format.hpp"

#include <stdexcept>
#include <string>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr char vertex_suffix[] = ".vert", face_suffix[] = ".face";

std::string suffix_of(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

std::filesystem::path with_suffix(std::filesystem::path file, const char* suffix) {
  return suffix_of(file) == suffix ? file : file.replace_extension(suffix);
}

}  // namespace

std::optional<MeshFormat> mesh_format(const std::filesystem::path& file) {
  const std::string suffix = suffix_of(file);
  if (suffix == ".ply") return MeshFormat::ply;
  if (suffix == ".obj") return MeshFormat::obj;
  if (suffix == ".off") return MeshFormat::off;
  if (suffix == ".vtp") return MeshFormat::vtp;
  if (suffix == ".stl") return MeshFormat::stl;
  if (suffix == ".glb") return MeshFormat::glb;
  if (suffix == vertex_suffix || suffix == face_suffix) return MeshFormat::msms;
  return std::nullopt;
}

bool can_have_colors(std::optional<MeshFormat> format) {
  return format == MeshFormat::ply || format == MeshFormat::ascii_ply ||
         format == MeshFormat::obj || format == MeshFormat::vtp || format == MeshFormat::glb;
}

MeshFormat required_mesh_format(const MeshOptions& mesh) {
  const std::optional<MeshFormat> format = mesh_format(mesh.file);
  if (!format)
    throw std::invalid_argument(formatted("the mesh file needs the suffix {}, found {}",
                                          mesh_suffixes, mesh.file.string()));
  if (!mesh.is_ascii) return *format;
  if (format != MeshFormat::ply)
    throw std::invalid_argument(
        formatted("only .ply meshes can be written as text, not {}", mesh.file.string()));
  return MeshFormat::ascii_ply;
}

std::vector<std::filesystem::path> mesh_files(const MeshOptions& mesh) {
  if (mesh_format(mesh.file) != MeshFormat::msms) return {mesh.file};
  return {with_suffix(mesh.file, vertex_suffix), with_suffix(mesh.file, face_suffix)};
}

}  // namespace eses::detail
