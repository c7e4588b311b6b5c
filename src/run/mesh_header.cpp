#include "run/mesh_header.hpp"

#include <array>
#include <functional>
#include <span>
#include <string_view>

#include "output/buffered_text.hpp"

namespace eses::detail {
namespace {

using WriteText = std::function<void(const TextSink& sink)>;

template <class AppendName>
WriteText lines_of(std::span<const AtomLabel> labels, std::uint64_t first, AppendName append_name) {
  return [=](const TextSink& sink) {
    BufferedText text(sink);
    for (std::size_t i = 0; i < labels.size(); ++i) append_name(text, first + i, labels[i]);
    text.flush();
  };
}

// Returns functions that write this process's share of each part of the header. In the file, the
// shares of a part follow each other in the order of ranks.
std::array<WriteText, 5> parts_of(const mesh::MeshText& text, const GroupNames& names,
                                  const MeshCounts& counts, bool is_first) {
  return {[&text, is_first](const TextSink& sink) {
            if (is_first) text.write_header_begin(sink);
          },
          lines_of(names.chains, names.first_chain,
                   [&text](BufferedText& pieces, std::uint64_t number, const AtomLabel& label) {
                     text.append_chain_name(pieces, number, label);
                   }),
          [&text, is_first](const TextSink& sink) {
            if (is_first) text.write_header_middle(sink);
          },
          lines_of(names.residues, names.first_residue,
                   [&text](BufferedText& pieces, std::uint64_t number, const AtomLabel& label) {
                     text.append_residue_name(pieces, number, label);
                   }),
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

std::uint64_t face_header_bytes(const mesh::MeshText& text) {
  return length_of([&](const TextSink& sink) { text.write_face_header({}, sink); });
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

std::uint64_t write_face_header(const mesh::MeshText& text, const MeshCounts& counts,
                                const Processes& processes, SharedFile& file) {
  std::uint64_t offset = 0;
  text.write_face_header(counts, [&](std::string_view piece) {
    if (processes.is_first()) file.write_at(piece, offset);
    offset += piece.size();
  });
  return offset;
}

}  // namespace eses::detail
