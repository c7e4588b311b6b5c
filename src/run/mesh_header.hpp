#pragma once
/// The header of a mesh file, which names chains and residues. Each process writes the names of the
/// groups whose first atom it has read.

#include <cstdint>

#include "distributed/group_numbers.hpp"
#include "distributed/processes.hpp"
#include "distributed/shared_file.hpp"
#include "output/mesh_format.hpp"
#include "output/mesh_writer.hpp"

namespace eses::detail {

/// Returns the length of the header in bytes, which does not depend on the counts. All processes
/// must call it.
std::uint64_t mesh_header_bytes(const mesh::MeshText& text, const GroupNames& names,
                                const Processes& processes);

/// Writes the header at the beginning of the file and returns its length in bytes. All processes
/// must call it.
std::uint64_t write_mesh_header(const mesh::MeshText& text, const GroupNames& names,
                                const MeshCounts& counts, const Processes& processes,
                                SharedFile& file);

/// These functions do the same for the separate file of the triangles, if the format has one.
std::uint64_t face_header_bytes(const mesh::MeshText& text);
std::uint64_t write_face_header(const mesh::MeshText& text, const MeshCounts& counts,
                                const Processes& processes, SharedFile& file);

}  // namespace eses::detail
