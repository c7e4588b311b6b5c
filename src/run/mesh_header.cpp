#include "run/mesh_header.hpp"

#include <span>
#include <string_view>

namespace eses::detail {
namespace {

template <class AppendName>
void append_names(std::span<const AtomLabel> labels, std::uint64_t first, const TextSink& sink,
                  AppendName append_name) {
  BufferedText text(sink);
  for (const AtomLabel& label : labels) append_name(text, first++, label);
  text.flush();
}

}  // namespace

void write_header_part(std::size_t part, const mesh::MeshText& text, const GroupNames& names,
                       bool is_first_process, const MeshCounts& counts, const mesh::VertexBox& box,
                       const TextSink& sink) {
  if (part == 1)
    append_names(names.chains, names.first_chain, sink,
                 [&](auto&&... name) { text.append_chain_name(name...); });
  if (part == 3)
    append_names(names.residues, names.first_residue, sink,
                 [&](auto&&... name) { text.append_residue_name(name...); });
  if (!is_first_process) return;
  if (part == 0) text.write_header_begin(sink);
  if (part == 2) text.write_header_middle(sink);
  if (part == 4) text.write_header_end(counts, box, sink);
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
  text.write_face_header(counts, [&](std::string_view piece) { header += piece; });
  return header;
}

}  // namespace eses::detail
