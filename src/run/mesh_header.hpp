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

/// Appends a process's text of a part of a header. In the file, the texts of a part follow each
/// other in the order of ranks.
using HeaderPart = std::function<void(BufferedText& text)>;
using HeaderParts = std::vector<HeaderPart>;

/// Returns the header of the mesh file. Keeps references to `mesh` and `names`. The length of the
/// header does not depend on `counts` and `box`.
HeaderParts mesh_header(const mesh::MeshText& mesh, const GroupNames& names,
                        const MeshCounts& counts, const Processes& processes,
                        const mesh::VertexBox& box = {});

/// Does the same for the separate file of the triangles, if the format has one.
HeaderParts face_header(const mesh::MeshText& mesh, const MeshCounts& counts,
                        const Processes& processes);

/// Returns the length of a header in bytes. All processes must call it.
std::uint64_t header_bytes(const HeaderParts& parts, const Processes& processes);

/// Writes a header at the beginning of the file and returns its length in bytes. All processes must
/// call it.
std::uint64_t write_header(const HeaderParts& parts, SharedFile& file);

}  // namespace eses::detail
