#pragma once
/// The headers of mesh files. A header may name chains and residues. Each process makes the names
/// of the groups whose first atom it has read.

#include <cstdint>
#include <functional>
#include <vector>

#include "distributed/group_numbers.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_file.hpp"
#include "output/mesh_writer.hpp"

namespace eses::detail {

/// Functions that pass a process's text of each part of a header to a sink. In the file, the texts
/// of a part follow each other in the order of ranks.
using HeaderParts = std::vector<std::function<void(const TextSink& sink)>>;

/// Returns the header of the mesh file. Keeps references to `text` and `names`. The length of the
/// header does not depend on `counts` and `box`.
HeaderParts mesh_header(const mesh::MeshText& text, const GroupNames& names,
                        const MeshCounts& counts, const Processes& processes,
                        const mesh::VertexBox& box = {});

/// Does the same for the separate file of the triangles, if the format has one.
HeaderParts face_header(const mesh::MeshText& text, const MeshCounts& counts,
                        const Processes& processes);

/// Returns the length of a header in bytes. All processes must call it.
std::uint64_t header_bytes(const HeaderParts& parts, const Processes& processes);

/// Writes a header at the beginning of the file and returns its length in bytes. All processes must
/// call it.
std::uint64_t write_header(const HeaderParts& parts, SharedFile& file);

}  // namespace eses::detail
