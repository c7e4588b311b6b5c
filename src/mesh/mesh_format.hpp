#pragma once
/// Formats of mesh files.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "eses/outputs.hpp"
#include "eses/summary.hpp"

namespace eses::detail {

/// The file tells the format by its suffix: `.ply` (binary), `.obj` or `.off`, in any case.
enum class MeshFormat : std::uint8_t { ply, obj, off };

/// None if the suffix is another one.
std::optional<MeshFormat> mesh_format(const std::filesystem::path& file);

}  // namespace eses::detail
