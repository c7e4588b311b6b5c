#pragma once
/// The headers of mesh files. A header may name chains and residues. Each process makes the names
/// of the groups whose first atom it has read.

#include <cstddef>
#include <cstdint>
#include <string>

#include "distributed/group_numbers.hpp"
#include "output/buffered_text.hpp"
#include "output/mesh_writer.hpp"

namespace eses::detail {

/// Number of parts of the header of the mesh file: 0 beginning, 1 names of chains, 2 middle, 3
/// names of residues, 4 end. In the file, the texts of a part follow each other in the order of
/// ranks.
inline constexpr std::size_t mesh_header_parts = 5;

/// Passes the text of this process for a part of the header to a sink. Its length does not depend
/// on `counts` and `box`.
void write_header_part(std::size_t part, const mesh::MeshText& text, const GroupNames& names,
                       bool is_first_process, const MeshCounts& counts, const mesh::VertexBox& box,
                       const TextSink& sink);

/// Returns the length of the header in a run with a single process, in bytes.
std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names);

/// Returns the header of the separate file of the triangles, if the format has one. Its length does
/// not depend on `counts`.
std::string face_header(const mesh::MeshText& text, const MeshCounts& counts = {});

}  // namespace eses::detail
