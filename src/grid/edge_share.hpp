#pragma once
/// How the part of a grid edge that lies inside the surface is stored.

#include <cstdint>

namespace eses::detail {

/// The part of an edge that lies inside is a whole number of 1 / `whole_edge` of its length.
inline constexpr std::uint32_t whole_edge = 0xFFFF'FFFF;

}  // namespace eses::detail
