#pragma once
/// Formats of mesh files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "eses/outputs.hpp"
#include "eses/summary.hpp"

namespace eses::detail {

/// The formats of meshes. MSMS has two files, the others one.
enum class MeshFormat : std::uint8_t { ply, obj, off, ascii_ply, msms, vtp };

/// The suffixes of mesh files, for messages.
inline constexpr char mesh_suffixes[] = ".ply, .obj, .off, .vtp, .vert or .face";

/// The format that belongs to a file's suffix, in upper or lower case; `ply` for both kinds of PLY.
/// None if the suffix is unknown.
std::optional<MeshFormat> mesh_format(const std::filesystem::path& file);

/// The format of a mesh. Throws Error if the suffix is unknown, or if text is chosen for another
/// format than PLY.
MeshFormat required_mesh_format(const MeshOptions& mesh);

/// The files of a mesh: one, or that of the vertices and that of the triangles. The file that
/// `mesh` names keeps its name; the suffix of the other one is in lower case.
std::vector<std::filesystem::path> mesh_files(const MeshOptions& mesh);

}  // namespace eses::detail
