#pragma once
/// The inside map as other programs read it: a value for every point of a regular grid, 1 inside
/// and 0 outside.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "eses/grid.hpp"

namespace eses::detail {

enum class MapFormat {
  dx,   ///< OpenDX as APBS writes it: text, z fastest, three values a line
  vti,  ///< VTK's XML image data: x fastest, a byte a value, raw behind the XML
};

/// By the end of the name: `.dx` or `.vti`.
std::optional<MapFormat> map_format(std::string_view name);

/// Throws Error if the name ends with neither.
MapFormat required_map_format(std::string_view name);

/// A map's text before and behind its values, each of which has the same number of bytes.
struct MapLayout {
  MapFormat format = MapFormat::dx;
  std::string header, footer;
  std::uint64_t value_bytes = 0;
  std::uint64_t points = 0;

  std::uint64_t value_offset(std::uint64_t index) const {
    return header.size() + index * value_bytes;
  }
  std::uint64_t file_bytes() const { return value_offset(points) + footer.size(); }
};

/// The map of the points of a region, with their places in the whole grid.
MapLayout map_layout(MapFormat format, const Grid& grid, const GridRegion& region);

/// Fills `values` with `.vti`'s bytes for as many bits.
void fill_vti_values(std::span<const std::uint64_t> bits, std::span<char> values);

/// Fills `text` with `.dx`'s text, all values 0, for the values from number `first_index` on: two
/// bytes a value, of which bit 0 of the first becomes 1 inside.
void fill_dx_zeros(std::uint64_t first_index, std::span<char> text);

}  // namespace eses::detail
