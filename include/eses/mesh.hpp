#pragma once
/// The surface as a mesh of triangles: what is to be written of it.

#include <cstdint>
#include <filesystem>
#include <optional>

namespace eses {

/// What the vertices of a PLY file are coloured by.
enum class MeshColor {
  none,
  patch,  ///< convex, saddle, concave
  atom,   ///< the first adjacent atom
  chain,  ///< that atom's chain; needs the molecule's labels
};

/// The file tells the format by its suffix: `.ply` (binary), `.obj` or `.off`, in any case.
enum class MeshFormat { ply, obj, off };

/// None if the suffix is another one.
std::optional<MeshFormat> mesh_format(const std::filesystem::path& file);

struct MeshChoice {
  std::filesystem::path file;
  MeshColor color = MeshColor::none;  ///< of PLY only
};

/// What a mesh has.
struct MeshCounts {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};

}  // namespace eses
