#include "run/mesh_header.hpp"

#include <string_view>

namespace eses::detail {

void write_header_part(std::size_t part, const mesh::MeshText& text, const GroupNames& names,
                       bool is_first_process, const MeshCounts& counts, const mesh::VertexBox& box,
                       const TextSink& sink) {
  BufferedText buffer(sink);
  if (part == 1)
    for (std::size_t i = 0; i < names.chains.size(); ++i)
      text.append_chain_name(buffer, names.first_chain + i, names.chains[i]);
  if (part == 3)
    for (std::size_t i = 0; i < names.residues.size(); ++i)
      text.append_residue_name(buffer, names.first_residue + i, names.residues[i]);
  if (is_first_process) {
    if (part == 0) text.append_header_begin(buffer);
    if (part == 2) text.append_header_middle(buffer);
    if (part == 4) text.append_header_end(buffer, counts, box);
  }
  buffer.flush();
}

std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names) {
  std::uint64_t bytes = 0;
  for (std::size_t part = 0; part < mesh_header_parts; ++part)
    write_header_part(part, text, names, true, {}, {},
                      [&](std::string_view piece) { bytes += piece.size(); });
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
