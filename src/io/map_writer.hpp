#pragma once
/// Maps as other programs read them: a value for every point of a regular grid, or for the middle
/// of every edge along an axis.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "grid/edge_share.hpp"

namespace eses::detail {

enum class MapFormat {
  dx,   ///< OpenDX as APBS writes it: text, z fastest, three values a line
  vti,  ///< VTK's XML image data: x fastest, a byte a value, raw behind the XML
};

/// By the end of the name: `.dx` or `.dx.gz`, or `.vti`.
std::optional<MapFormat> map_format(std::string_view name);

/// Returns whether the file of a map of this name is compressed: whether it ends with `.dx.gz`.
bool is_compressed_map(std::string_view name);

/// Throws Error if the name has none of these ends.
MapFormat required_map_format(std::string_view name);

/// The quantity of a map.
enum class MapQuantity : std::uint8_t {
  inside,      ///< of points: 1 inside the surface, else 0
  ion_access,  ///< of points: 1 where the centre of an ion may be, else 0
  dielectric_x,
  dielectric_y,
  dielectric_z,  ///< these three: of edges, the dielectric
};
inline constexpr std::size_t map_quantities = 5;

/// Returns whether a map has values of edges, not of points.
constexpr bool is_of_edges(MapQuantity quantity) { return quantity >= MapQuantity::dielectric_x; }

/// The axis of the edges of a map that has values of edges.
constexpr std::size_t edge_axis(MapQuantity quantity) {
  return static_cast<std::size_t>(quantity) - static_cast<std::size_t>(MapQuantity::dielectric_x);
}

/// One map file.
struct MapChoice {
  MapQuantity quantity = MapQuantity::inside;
  std::string name;  ///< in the output directory
  MapFormat format = MapFormat::dx;
  double solute = 0, solvent = 0;  ///< relative permittivities, of a map of edges
  bool gzip = false;               ///< whether the file is compressed
};

/// Bounds of a dielectric, such that its text has the same length everywhere, and of the radius of
/// ions (angstrom).
inline constexpr double min_dielectric = 1e-9, max_dielectric = 1e9, max_ion_radius = 1000;

/// Name of a map of the dielectric in the output directory.
std::string dielectric_name(std::string_view prefix, MapQuantity quantity, bool gzip);

/// The maps that are chosen, at most one of each quantity, in their order. Throws Error as
/// required_map_format does.
std::vector<MapChoice> chosen_maps(const Outputs& outputs);

/// Throws Error if a number is out of its range, or two maps have the same name.
void require_valid_maps(const Outputs& outputs);

/// The dielectric of an edge with `share` parts inside: the harmonic mean along the edge.
double dielectric_of(const MapChoice& map, std::uint32_t share);

/// Text of a value of a map of edges, the blank or line end behind it included.
inline constexpr std::size_t dielectric_text_bytes = 13;

/// Writes the text of a value, but not what is behind it.
void write_dielectric(char* text, double value);

/// Returns the character behind value number `index` (from 0) in a .dx file: three values a line.
constexpr char dx_separator(std::uint64_t index) { return index % 3 == 2 ? '\n' : ' '; }

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

/// The map of the points of a region, or of the edges that start there, with their places in the
/// whole grid.
MapLayout map_layout(const MapChoice& map, const Grid& grid, const GridRegion& region);

/// Fills `values` with `.vti`'s bytes for as many bits.
void fill_vti_values(std::span<const std::uint64_t> bits, std::span<char> values);

/// Fills `text` with `.dx`'s text, all values 0, for the values from number `first_index` on: two
/// bytes a value, of which bit 0 of the first becomes 1 where the value is 1.
void fill_dx_zeros(std::uint64_t first_index, std::span<char> text);

}  // namespace eses::detail
