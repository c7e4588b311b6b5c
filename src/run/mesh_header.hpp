#pragma once
/// The headers of mesh files. A header may name chains and residues. Each process makes the names
/// of the groups whose first atom it has read.

#include <string>
#include <vector>

#include "distributed/group_numbers.hpp"
#include "output/mesh_writer.hpp"

namespace eses::detail {

/// Returns the text of this process for each part of the header of the mesh file. In the file, the
/// texts of a part follow each other in the order of ranks. The length of the header does not
/// depend on `counts` and `box`.
std::vector<std::string> mesh_header(const mesh::MeshText& text, const GroupNames& names,
                                     bool is_first_process, const MeshCounts& counts = {},
                                     const mesh::VertexBox& box = {});

/// Returns the header of the separate file of the triangles, if the format has one. Its length does
/// not depend on `counts`.
std::string face_header(const mesh::MeshText& text, const MeshCounts& counts = {});

}  // namespace eses::detail
