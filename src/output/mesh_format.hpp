#pragma once
/// Formats of mesh files, the colours of their vertices, and the names of chains and residues.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/outputs.hpp"

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

namespace mesh {

/// Red, green and blue, 0 to 255.
using Color = std::array<std::uint8_t, 3>;

/// Colour of a patch: 1 convex, 2 saddle, 3 concave.
Color patch_color(std::uint8_t patch);

/// Colour of a number, which differs clearly from the colours of the next numbers.
Color distinct_color(std::uint64_t number);

/// Colour of a component: grey for 0, the outside, and the colour of a number for each cavity.
Color component_color(std::uint32_t component);

/// Colour of a potential on a scale from -`limit` (red) over 0 (white) to `limit` (blue).
Color potential_color(double potential, double limit);

/// Returns the beginning of a name, as written to a mesh file. Names are truncated because PLY
/// readers limit the length of lines.
std::string_view truncated_name(std::string_view name);

/// Returns a residue as a mesh file names it, such as `LYS 12 A`.
std::string residue_text(const AtomLabel& label);

}  // namespace mesh
}  // namespace eses::detail
