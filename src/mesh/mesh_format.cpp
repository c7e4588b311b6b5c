#include <algorithm>
#include <string>

#include "eses/mesh.hpp"

namespace eses {

std::optional<MeshFormat> mesh_format(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  // Locale must not matter, hence not std::tolower.
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (suffix == ".ply") return MeshFormat::ply;
  if (suffix == ".obj") return MeshFormat::obj;
  if (suffix == ".off") return MeshFormat::off;
  return std::nullopt;
}

}  // namespace eses
