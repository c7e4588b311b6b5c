#include "run/mesh_header.hpp"

#include <cstddef>

namespace eses::detail {
namespace {

// Makes the text of a part of a header.
void make_part(const HeaderPart& append, const TextSink& sink) {
  BufferedText text(sink);
  append(text);
  text.flush();
}

}  // namespace

HeaderParts mesh_header(const mesh::MeshText& mesh, const GroupNames& names,
                        const MeshCounts& counts, const Processes& processes,
                        const mesh::VertexBox& box) {
  const bool is_first = processes.is_first();
  return {[&mesh, is_first](BufferedText& text) {
            if (is_first) mesh.append_header_begin(text);
          },
          [&mesh, &names](BufferedText& text) {
            for (std::size_t i = 0; i < names.chains.size(); ++i)
              mesh.append_chain_name(text, names.first_chain + i, names.chains[i]);
          },
          [&mesh, is_first](BufferedText& text) {
            if (is_first) mesh.append_header_middle(text);
          },
          [&mesh, &names](BufferedText& text) {
            for (std::size_t i = 0; i < names.residues.size(); ++i)
              mesh.append_residue_name(text, names.first_residue + i, names.residues[i]);
          },
          [&mesh, counts, box, is_first](BufferedText& text) {
            if (is_first) mesh.append_header_end(text, counts, box);
          }};
}

HeaderParts face_header(const mesh::MeshText& mesh, const MeshCounts& counts,
                        const Processes& processes) {
  return {[&mesh, counts, is_first = processes.is_first()](BufferedText& text) {
    if (is_first) mesh.append_face_header(text, counts);
  }};
}

std::uint64_t header_bytes(const HeaderParts& parts, const Processes& processes) {
  std::uint64_t bytes = 0;
  for (const HeaderPart& part : parts)
    make_part(part, [&](std::string_view text) { bytes += text.size(); });
  return processes.sum(bytes);
}

std::uint64_t write_header(const HeaderParts& parts, SharedFile& file) {
  std::uint64_t bytes = 0;
  for (const HeaderPart& part : parts)
    bytes += file.write_by_rank(bytes, [&](const TextSink& sink) { make_part(part, sink); });
  return bytes;
}

}  // namespace eses::detail
