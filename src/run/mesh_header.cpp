#include "run/mesh_header.hpp"

#include <span>

namespace eses::detail {
namespace {

TextSink append_to(std::string& text) {
  return [&text](std::string_view part) { text += part; };
}

template <class AppendName>
std::string names_text(std::span<const AtomLabel> labels, std::uint64_t first,
                       AppendName append_name) {
  std::string names;
  const TextSink sink = append_to(names);
  BufferedText text(sink);
  for (const AtomLabel& label : labels) append_name(text, first++, label);
  text.flush();
  return names;
}

}  // namespace

std::vector<std::string> mesh_header(const mesh::MeshText& text, const GroupNames& names,
                                     bool is_first_process, const MeshCounts& counts,
                                     const mesh::VertexBox& box) {
  std::string begin, middle, end;
  if (is_first_process) {
    text.write_header_begin(append_to(begin));
    text.write_header_middle(append_to(middle));
    text.write_header_end(counts, box, append_to(end));
  }
  return {begin,
          names_text(names.chains, names.first_chain,
                     [&](auto&&... name) { text.append_chain_name(name...); }),
          middle,
          names_text(names.residues, names.first_residue,
                     [&](auto&&... name) { text.append_residue_name(name...); }),
          end};
}

std::string face_header(const mesh::MeshText& text, const MeshCounts& counts) {
  std::string header;
  text.write_face_header(counts, append_to(header));
  return header;
}

}  // namespace eses::detail
