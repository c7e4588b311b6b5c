#include "mesh/mesh_format.hpp"

#include <string>

#include "io/text_fields.hpp"

namespace eses::detail {

std::optional<MeshFormat> mesh_format(const std::filesystem::path& file) {
  const std::string suffix = lower_case(file.extension().string());
  if (suffix == ".ply") return MeshFormat::ply;
  if (suffix == ".obj") return MeshFormat::obj;
  if (suffix == ".off") return MeshFormat::off;
  return std::nullopt;
}

}  // namespace eses::detail
