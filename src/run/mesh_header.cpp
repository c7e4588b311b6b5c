#include "run/mesh_header.hpp"

#include <string_view>

namespace eses::detail {

void write_mesh_header(const mesh::MeshText& text, const GroupNames& names,
                       const MeshCounts& counts, const mesh::VertexBox& box, const TextSink& sink) {
  BufferedText buffer(sink);
  text.append_header_begin(buffer);
  for (std::size_t i = 0; i < names.chains.size(); ++i)
    text.append_chain_name(buffer, i, names.chains[i]);
  text.append_header_middle(buffer);
  for (std::size_t i = 0; i < names.residues.size(); ++i)
    text.append_residue_name(buffer, i, names.residues[i]);
  text.append_header_end(buffer, counts, box);
  buffer.flush();
}

std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names) {
  std::uint64_t bytes = 0;
  write_mesh_header(text, names, {}, {}, [&](std::string_view piece) { bytes += piece.size(); });
  return bytes;
}

std::string face_header(const mesh::MeshText& text, const MeshCounts& counts) {
  std::string header;
  BufferedText buffer([&](std::string_view piece) { header += piece; });
  text.append_face_header(buffer, counts);
  buffer.flush();
  return header;
}

}  // namespace eses::detail
