#pragma once
/// Maps for other programs: a value for each point of a regular grid, or for the midpoint of each
/// edge along an axis; in memory, and as files.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "geometry/map_rows.hpp"
#include "output/file.hpp"

namespace eses::detail {

enum class MapFormat {
  dx,   ///< OpenDX as APBS writes it: text, z fastest, three values a line
  vti,  ///< VTK XML image data: x fastest, one byte a value, raw data after the XML
};

/// Returns the format by the suffix: `.dx`, `.dx.gz` or `.vti`.
std::optional<MapFormat> map_format(std::string_view name);

/// The quantity of a map.
enum class MapQuantity : std::uint8_t {
  inside,      ///< points: 1 inside the surface, else 0
  ion_access,  ///< points: 1 where the centre of an ion may be, else 0
  dielectric_x,
  dielectric_y,
  dielectric_z,  ///< all three: edges, the dielectric
};
inline constexpr std::size_t map_quantities = 5;

/// Returns whether the values of a map belong to edges rather than points.
constexpr bool is_of_edges(MapQuantity quantity) { return quantity >= MapQuantity::dielectric_x; }

/// Returns the axis of the edges of a map.
constexpr std::size_t edge_axis(MapQuantity quantity) {
  return static_cast<std::size_t>(quantity) - static_cast<std::size_t>(MapQuantity::dielectric_x);
}

/// One map file.
struct MapChoice {
  MapQuantity quantity = MapQuantity::inside;
  std::string name;  ///< file name in the output directory
  MapFormat format = MapFormat::dx;
  double solute = 0, solvent = 0;  ///< relative permittivities, for maps of edges
  bool gzip = false;               ///< whether the file is compressed
};

/// Bounds of a dielectric, within which all its texts have the same length, and of the radius of
/// ions (angstrom).
inline constexpr double min_dielectric = 1e-9, max_dielectric = 1e9, max_ion_radius = 1000;

/// Returns the chosen maps in the order of MapQuantity. Throws std::invalid_argument if the map of
/// the inside has an unknown suffix.
std::vector<MapChoice> chosen_maps(const Outputs& outputs);

/// Throws std::invalid_argument if a number is out of range, or if two maps have the same name.
void require_valid_maps(const Outputs& outputs);

/// Returns the dielectric of an edge: the harmonic mean along the edge. `fraction` is the part of
/// the edge that is inside, in units of 1 / whole_edge.
double dielectric_of(const MapChoice& map, std::uint32_t fraction);

/// Number of values in a line of a .dx file.
inline constexpr std::uint64_t dx_values_per_line = 3;

/// Length of a value of a map of edges as text, with its separator.
inline constexpr std::size_t dielectric_text_bytes = 13;

/// The header and footer of a map file, and the size of a value.
struct MapLayout {
  std::string header, footer;
  std::uint64_t value_bytes = 0;
  std::uint64_t points = 0;

  std::uint64_t file_bytes() const { return header.size() + points * value_bytes + footer.size(); }
};

/// Returns the layout of the map of a region. `surface` is its name. Coordinates and indices refer
/// to the whole grid.
MapLayout map_layout(const MapChoice& map, std::string_view surface, const Grid& grid,
                     const GridRegion& region);

/// A map that is filled by rows along x, which arrive in any order, and then written. It takes one
/// bit for each value; a map of edges takes 16 bytes more for each edge that the surface crosses. A
/// `.vti` file has x running fastest; in a `.dx` file z runs fastest, so that the values are
/// transposed.
class GridMap {
 public:
  /// `surface` is its name, for the header of the file.
  GridMap(MapChoice map, std::string_view surface, const Grid& grid, const GridRegion& region);

  MapQuantity quantity() const { return map_.quantity; }
  /// Adds rows. `first_row` is the 0-based number of the first one in the region. Several threads
  /// may call it for different rows.
  void add_rows(std::int64_t first_row, const MapRows& rows);

  /// Writes the file after all rows have been added. Calls `check` many times, also from several
  /// threads at the same time.
  void write(OutputFile& file, int threads, const std::function<void()>& check);

  /// Typical size of a compressed map of a surface with so many crossings.
  static std::uint64_t typical_compressed_bytes(const MapChoice& map, const GridRegion& region,
                                                double crossings);
  /// Returns the estimated memory in bytes of a map of a surface with so many crossings, which is
  /// also that of its rows.
  static double memory_bytes(const MapChoice& map, const GridRegion& region, double crossings);
  /// Upper bound of the memory of a thread that writes, in bytes.
  static double thread_bytes(const MapChoice& map, const GridRegion& region);

 private:
  // An edge that is partly inside. `index` is the index of its value in a `.dx` file.
  struct DxEdge {
    std::uint64_t index;
    std::uint32_t fraction;
  };
  struct Slice;

  std::uint64_t dx_index(std::int64_t x, std::int64_t row) const;
  template <std::size_t digits>
  void fill_slice(const Slice& slice, std::vector<char>& text) const;
  void fill_plane(std::int64_t z, std::vector<char>& bytes) const;

  MapChoice map_;
  MapLayout layout_;
  GridIndex size_{};
  std::array<std::string, 2> texts_;  // of values whose bit is 0 and 1
  // Bit i % 64 of word [i / 64][z][y] is point i of row (y, z), or whether its edge is wholly
  // inside.
  std::vector<std::uint64_t> bits_;
  std::mutex mutex_;
  std::deque<DxEdge> partial_edges_;  // sorted by `write`
};

}  // namespace eses::detail
