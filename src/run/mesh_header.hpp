#pragma once
/// The headers of mesh files. A header may name chains and residues.

#include <cstdint>
#include <string>

#include "output/buffered_text.hpp"
#include "output/mesh_writer.hpp"
#include "run/group_names.hpp"

namespace eses::detail {

/// Passes the header of the mesh file to a sink. Its length does not depend on `counts` and `box`.
void write_mesh_header(const mesh::MeshText& text, const GroupNames& names,
                       const MeshCounts& counts, const mesh::VertexBox& box, const TextSink& sink);

/// Returns the length of the header in bytes.
std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names);

/// Returns the header of the separate file of the triangles, if the format has one. Its length does
/// not depend on `counts`.
std::string face_header(const mesh::MeshText& text, const MeshCounts& counts = {});

}  // namespace eses::detail
