#include "compute/mesh_file.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace eses {

MeshFile::MeshFile(const Plan& plan, const MeshChoice& choice, std::span<const AtomLabel> labels,
                   OutputFile& file, const std::filesystem::path& directory)
    : file_(file),
      triangles_(directory),
      text_(mesh_format(choice.file).value(), choice.color,
            mesh::group_atoms(mesh::names_atoms(choice) ? labels : std::span<const AtomLabel>())),
      header_bytes_(text_.header_bytes()),
      output_(plan, plan.tiling.corners, text_,
              {.vertices =
                   [this](std::span<const char> text, std::uint64_t offset) {
                     file_.write_at(text, header_bytes_ + offset);
                   },
               .triangles =
                   [this](std::span<const char> text, std::uint64_t offset) {
                     triangles_.write_at(std::as_bytes(text), offset);
                   }}) {}

std::uint64_t MeshFile::finish(const MeshCounts& counts, const std::function<void()>& check) {
  std::uint64_t at = 0;
  text_.write_header(counts, [&](std::string_view piece) {
    file_.write_at(piece, at);
    at += piece.size();
  });
  at += output_.vertex_bytes();
  const std::uint64_t bytes = output_.triangle_bytes();
  std::vector<char> buffer(std::size_t{1} << 20);
  for (std::uint64_t done = 0; done < bytes;) {
    const auto part = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), bytes - done));
    triangles_.read_at(std::as_writable_bytes(part), done);
    file_.write_at(part, at);
    done += part.size();
    at += part.size();
    check();
  }
  return at;
}

}  // namespace eses
