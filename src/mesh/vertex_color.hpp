#pragma once
/// Colours of vertices.

#include <array>
#include <cstdint>

namespace eses::detail::mesh {

/// Red, green and blue.
using Color = std::array<std::uint8_t, 3>;

/// The colour of a patch: 1 convex, 2 saddle, 3 concave.
Color patch_color(std::uint8_t patch);

/// A colour for a number, far from those of the numbers beside it.
Color wheel_color(std::uint64_t number);

}  // namespace eses::detail::mesh
