#include "compute/mesh_header.hpp"

#include <array>
#include <functional>
#include <span>
#include <string_view>

#include "io/text_pieces.hpp"

namespace eses::detail {
namespace {

using WriteText = std::function<void(const TextSink& sink)>;

template <class AppendName>
WriteText lines_of(std::span<const AtomLabel> labels, std::uint64_t first, AppendName append_name) {
  return [=](const TextSink& sink) {
    TextPieces text(sink);
    for (std::size_t i = 0; i < labels.size(); ++i) append_name(text, first + i, labels[i]);
    text.flush();
  };
}

// The parts of the header in their order. In the file, each part is that of all processes by rank.
std::array<WriteText, 4> parts_of(const mesh::MeshText& text, const GroupNames& names,
                                  const MeshCounts& counts, bool is_first) {
  return {[&text, is_first](const TextSink& sink) {
            if (is_first) text.write_header_begin(sink);
          },
          lines_of(names.chains, names.first_chain, mesh::append_chain_name),
          lines_of(names.residues, names.first_residue, mesh::append_residue_name),
          [&text, counts, is_first](const TextSink& sink) {
            if (is_first) text.write_header_end(counts, sink);
          }};
}

std::uint64_t length_of(const WriteText& part) {
  std::uint64_t bytes = 0;
  part([&](std::string_view text) { bytes += text.size(); });
  return bytes;
}

}  // namespace

std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names,
                                const Processes& processes) {
  std::uint64_t bytes = 0;
  for (const WriteText& part : parts_of(text, names, {}, processes.is_first()))
    bytes += length_of(part);
  return processes.sum(bytes);
}

std::uint64_t write_mesh_header(const mesh::MeshText& text, const GroupNames& names,
                                const MeshCounts& counts, const Processes& processes,
                                SharedFile& file) {
  std::uint64_t begin = 0;
  for (const WriteText& part : parts_of(text, names, counts, processes.is_first())) {
    const std::uint64_t bytes = length_of(part);
    std::uint64_t offset = begin + processes.sum_before(bytes);
    part([&](std::string_view chunk) {
      file.write_at(chunk, offset);
      offset += chunk.size();
    });
    begin += processes.sum(bytes);
  }
  return begin;
}

}  // namespace eses::detail
