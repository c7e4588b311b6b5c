#pragma once
/// Colours of vertices.

#include <array>
#include <cstdint>

namespace eses::detail::mesh {

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

}  // namespace eses::detail::mesh
