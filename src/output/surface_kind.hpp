#pragma once
/// The surfaces and their names.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace eses::detail {

/// The surface of a run. The solvent accessible surface is the van der Waals surface of atoms whose
/// radii are larger by the radius of the probe.
enum class SurfaceKind : std::uint8_t { ses, sas, vdw };

/// A surface with its short name, as in options, and its name in texts.
struct SurfaceName {
  std::string_view option, name;
};

/// The names in the order of SurfaceKind.
inline constexpr std::array surface_names{SurfaceName{"ses", "solvent excluded surface"},
                                          SurfaceName{"sas", "solvent accessible surface"},
                                          SurfaceName{"vdw", "van der Waals surface"}};

/// Returns the names of a surface.
constexpr const SurfaceName& names_of(SurfaceKind kind) {
  return surface_names[static_cast<std::size_t>(kind)];
}

}  // namespace eses::detail
