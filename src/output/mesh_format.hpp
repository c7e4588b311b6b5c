#pragma once
/// Formats of mesh files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "eses/outputs.hpp"
#include "eses/summary.hpp"

namespace eses::detail {

/// Formats of mesh files. An MSMS mesh has two files, other meshes have one.
enum class MeshFormat : std::uint8_t { ply, obj, off, ascii_ply, msms, vtp, stl, glb };

/// The suffixes of mesh files, for messages.
inline constexpr char mesh_suffixes[] = ".ply, .obj, .off, .vtp, .stl, .glb, .vert or .face";

/// Format of a file by its suffix in upper or lower case: `ply` for both kinds of PLY, no value if
/// the suffix is unknown.
std::optional<MeshFormat> mesh_format(const std::filesystem::path& file);

/// Whether meshes of a format can have colours; no value stands for a file without a known suffix.
bool can_have_colors(std::optional<MeshFormat> format);

/// Format of a mesh. Throws std::invalid_argument if the suffix is unknown, or if `is_ascii` is set
/// for another format than PLY.
MeshFormat required_mesh_format(const MeshOptions& mesh);

/// Paths of the files of a mesh: one, or for MSMS the file of the vertices and the file of the
/// triangles. The path in `mesh` is kept as it is; the other one gets its suffix in lower case.
std::vector<std::filesystem::path> mesh_files(const MeshOptions& mesh);

}  // namespace eses::detail
