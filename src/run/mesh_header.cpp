#include "run/mesh_header.hpp"

#include <span>

namespace eses::detail {
namespace {

template <class AppendName>
void append_names(std::span<const AtomLabel> labels, std::uint64_t first, const TextSink& sink,
                  AppendName append_name) {
  BufferedText text(sink);
  for (std::size_t i = 0; i < labels.size(); ++i) append_name(text, first + i, labels[i]);
  text.flush();
}

}  // namespace

HeaderParts mesh_header(const mesh::MeshText& text, const GroupNames& names,
                        const MeshCounts& counts, const Processes& processes,
                        const mesh::VertexBox& box) {
  const bool is_first = processes.is_first();
  return {[&text, is_first](const TextSink& sink) {
            if (is_first) text.write_header_begin(sink);
          },
          [&text, &names](const TextSink& sink) {
            append_names(names.chains, names.first_chain, sink,
                         [&](auto&&... name) { text.append_chain_name(name...); });
          },
          [&text, is_first](const TextSink& sink) {
            if (is_first) text.write_header_middle(sink);
          },
          [&text, &names](const TextSink& sink) {
            append_names(names.residues, names.first_residue, sink,
                         [&](auto&&... name) { text.append_residue_name(name...); });
          },
          [&text, counts, box, is_first](const TextSink& sink) {
            if (is_first) text.write_header_end(counts, box, sink);
          }};
}

HeaderParts face_header(const mesh::MeshText& text, const MeshCounts& counts,
                        const Processes& processes) {
  return {[&text, counts, is_first = processes.is_first()](const TextSink& sink) {
    if (is_first) text.write_face_header(counts, sink);
  }};
}

std::uint64_t header_bytes(const HeaderParts& parts, const Processes& processes) {
  std::uint64_t bytes = 0;
  for (const auto& make : parts) make([&](std::string_view text) { bytes += text.size(); });
  return processes.sum(bytes);
}

std::uint64_t write_header(const HeaderParts& parts, SharedFile& file) {
  std::uint64_t bytes = 0;
  for (const auto& make : parts) bytes += file.write_by_rank(bytes, make);
  return bytes;
}

}  // namespace eses::detail
